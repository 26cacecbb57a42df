#include "libperception/simulation/recorded/AlteredRecording.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>

#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"
#include "libperception/simulation/Simulator.h"
#include "libperception/simulation/lidar/PointTruth.h"
#include "libperception/simulation/recorded/RecordedScene.h"

namespace perception {
namespace {

/// What has to be known of a recording before its first scan.
struct Recording {
  std::optional<Stamp> first, last;
  std::vector<RecordedPose> poses;
  std::set<std::string> sensors, lidars;  // labels
};

Recording surveyOf(const std::string& file, const RecordingStep& step) {
  Recording found;
  EgoPose ego;
  RawlogReader log(file);
  while (const auto observation = log.next()) {
    step(0, 0);
    const auto stamp = toStamp(observation->timestamp);
    if (!stamp) continue;
    if (!found.first) found.first = stamp;
    found.last = stamp;
    ego.add(*observation);
    if (!isSensorData(*observation)) continue;
    if (!isImage(*observation) && found.sensors.insert(observation->sensorLabel).second) {
      const auto frame = frameFromObservation(*observation);
      if (frame && std::holds_alternative<LidarCloud>(frame->data))
        found.lidars.insert(frame->sensor);
    }
    if (const auto state = ego.at(*stamp))
      found.poses.push_back({*stamp - *found.first, state->T_world_ego});
  }
  if (!found.first) throw DataError(file + ": no observation with a stamp");
  return found;
}

/// The log's first entry.
mrpt::obs::CObservationComment simulatedComment(Stamp stamp, const std::string& text) {
  mrpt::obs::CObservationComment comment;
  comment.timestamp = fromStamp(stamp);
  comment.sensorLabel = "SIMULATED";
  comment.text = kSimulatedText + text;
  return comment;
}

/// Alters entry by entry. Returns what is wrong with the input, or nothing.
std::string alter(WeatheredLog& weathered, const std::string& input, bool labeled,
                  const LabelSink& write_labels, const RecordingStep& step, RawlogWriter& out) {
  RawlogReader log(input);
  std::int64_t last_labeled = -1;
  while (const auto observation = log.next()) {
    step(log.bytesRead(), weathered.counts().scans);
    if (const auto altered = weathered.apply(observation)) out.write(*altered);
    if (labeled && weathered.labels() && weathered.frame() > last_labeled) {
      last_labeled = weathered.frame();
      write_labels(last_labeled, *weathered.labels());
    }
  }
  return log.end() == RawlogReader::End::kClean ? "" : log.endMessage();
}

}  // namespace

AlteredRecording alteredRecording(const RecordingTask& task, const LabelSink& write_labels,
                                  const RecordingStep& step) {
  namespace fs = std::filesystem;
  const Recording recording = surveyOf(task.input, step);
  const std::string truth_file = truthFileOf(task.input);
  const bool has_truth = fs::exists(truth_file);
  const GroundTruth truth = has_truth ? readGroundTruth(truth_file) : GroundTruth{};
  AlteredRecording done;
  done.duration = *recording.last - *recording.first;
  Scenario scene = recordedScene(truth, recording.poses, done.duration);
  scene.weather = task.weather;
  WeatheredLog weathered(std::move(scene), *recording.first, task.seed, task.threads,
                         imagesBeside(task.input));
  done.text = weathered.text();
  RawlogWriter out(task.output);
  removeLabels(task.output);
  out.write(simulatedComment(*recording.first, done.text));
  // Labels are by frame number.
  const bool labeled = recording.lidars.size() == 1;
  if (auto fault = alter(weathered, task.input, labeled, write_labels, step, out); !fault.empty())
    done.warnings.push_back(std::move(fault));
  out.finish();
  if (has_truth) {
    done.truth_file = truthFileOf(task.output);
    std::error_code error;
    fs::copy_file(truth_file, done.truth_file, fs::copy_options::overwrite_existing, error);
    if (error) throw OutputError(done.truth_file + ": cannot write: " + error.message());
  }
  out.close();
  done.counts = weathered.counts();
  done.entries = out.entries(), done.bytes = out.bytes();
  if (done.counts.images_left_out > 0)
    done.warnings.push_back(fmt::format("{} images left out: not found, or without a calibration",
                                        done.counts.images_left_out));
  if (!has_truth && (task.weather.water_film_mm > 0 || task.weather.snow_cover > 0))
    done.warnings.push_back(truth_file + ": not there, so that no object whirls up spray");
  if (recording.poses.empty())
    done.warnings.push_back(task.input + ": no poses: the vehicle is taken to stand");
  return done;
}

std::string textOf(const WeatheredLog::Counts& n) {
  std::string text = fmt::format("  lidar: {} scans, {} returns: {} lost, {} phantoms\n", n.scans,
                                 n.returns, n.lost, n.phantoms);
  if (n.targets > 0)
    text += fmt::format("  radar: {} targets, {} lost\n", n.targets, n.targets_lost);
  if (n.images > 0) text += fmt::format("  images: {}, {} left out\n", n.images, n.images_left_out);
  if (n.boxes > 0) text += fmt::format("  boxes: {}, {} lost\n", n.boxes, n.boxes_lost);
  return text;
}

}  // namespace perception
