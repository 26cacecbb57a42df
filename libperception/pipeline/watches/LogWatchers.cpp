#include "libperception/pipeline/watches/LogWatchers.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>

#include <algorithm>
#include <iterator>

#include "libperception/pipeline/input/LogRecorder.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"

namespace perception {
namespace {

/// As the simulator (scenarios) and simulated weather on recordings write it.
std::string weatherOf(const std::string& comment) {
  const std::string of_scenario = "; weather: ", of_recording = "weather on a recording: ";
  if (const auto at = comment.rfind(of_scenario); at != std::string::npos)
    return comment.substr(at + of_scenario.size());
  if (const auto at = comment.find(of_recording); at != std::string::npos) {
    const auto from = at + of_recording.size();
    const std::string text = comment.substr(from, comment.rfind(", seed ") - from);
    return text == "clear" ? "" : text;
  }
  return "";
}

}  // namespace

void LogFacts::look(const mrpt::obs::CObservation& observation) {
  if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation)) {
    if (comment->text.rfind("simulated log", 0) == 0) {
      simulated = true;
      if (!weather) weather = weatherOf(comment->text);
    }
  }
  if (camera || dynamic_cast<const CObservationObjectDetections*>(&observation) == nullptr) return;
  const auto frame = frameFromObservation(observation);
  const auto* detections = frame ? std::get_if<ObjectDetections>(&frame->data) : nullptr;
  if (!detections || detections->camera.width <= 0) return;
  // Without a pose of the camera the boxes are in its own frame, if they are image boxes alone.
  const bool of_image = !detections->objects.empty() &&
                        std::all_of(detections->objects.begin(), detections->objects.end(),
                                    [](const auto& o) { return !o.space_box && o.image_box; });
  if (!detections->T_ego_camera && !of_image) return;
  camera = KittiCamera{detections->camera, detections->T_ego_camera.value_or(frame->T_ego_sensor),
                       simulated ? Vector3(Vector3::Zero()) : KittiCamera::kittiOffset()};
}

void ObjectEvents::add(const Scene& scene) {
  std::set<std::uint64_t> now;
  for (const auto& o : scene.objects) {
    now.insert(o.id);
    const std::string& name = classes_[o.class_id].name;
    if (born_.insert(o.id).second) {
      ++objects_;
      events_.add(scene.stamp, event_kind::kTrackBorn, fmt::format("object {}", o.id),
                  {{"id", o.id}, {"class", name}});
    }
    if (o.classified && classified_.insert(o.id).second) {
      events_.add(scene.stamp, event_kind::kTrackConfirmed,
                  fmt::format("object {} is a {}", o.id, name), {{"id", o.id}, {"class", name}});
    }
  }
  for (const auto id : last_) {
    if (now.count(id) == 0)
      events_.add(scene.stamp, event_kind::kTrackLost, fmt::format("object {}", id), {{"id", id}});
  }
  last_ = std::move(now);
}

void ObjectEvents::keepOnly(const std::set<std::uint64_t>& ids) {
  for (auto* known : {&born_, &classified_}) {
    std::set<std::uint64_t> kept;
    std::set_intersection(known->begin(), known->end(), ids.begin(), ids.end(),
                          std::inserter(kept, kept.end()));
    known->swap(kept);
  }
  full_ = 2 * born_.size() + kFewIds;
}

void MeasurementRecorder::onScan(const MeasurementScan& scan) {
  const auto known = sensors_.find(scan.sensor);
  const RecordedSensor& sensor = known != sensors_.end() ? known->second : add(scan);
  writer_.write(recordScan(scan, sensor), sensor, *pipeline_.firstStamp());
}

const RecordedSensor& MeasurementRecorder::add(const MeasurementScan& scan) {
  RecordedSensor sensor = describeSensor(pipeline_.setup(), scan);
  writer_.writeSensor(sensor);
  return sensors_.emplace(scan.sensor, std::move(sensor)).first->second;
}

}  // namespace perception
