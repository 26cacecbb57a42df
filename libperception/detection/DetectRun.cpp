#include "libperception/detection/DetectRun.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"
#include "libperception/detection/DetectPicture.h"
#include "libperception/detection/DetectResults.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr double kKittiCameraHeight = 1.65;  // [m] kitti.com/setup: cameras above the ground

}  // namespace

DetectRun::DetectRun(const ImageDetector& detector, DetectCameraParams camera,
                     DetectOptions options, std::function<void(const std::string&)> warn)
    : detector_(detector),
      camera_(camera),
      options_(std::move(options)),
      warn_(std::move(warn)),
      quality_(options_.overlap, options_.rules.min_height) {}

ObjectDetections DetectRun::timed(const Raster& image, const CameraModel& camera,
                                  const std::optional<Pose3>& pose) {
  const auto start = std::chrono::steady_clock::now();
  auto found = detector_.detect(image, camera, pose);
  totals_.seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

void DetectRun::finish(Result& result) {
  if (!options_.labels.empty()) quality_.add(result.truth, result.found.objects);
  auto& objects = result.found.objects;
  for (const ObjectDetection& o : objects) result.raw.push_back(o.score);
  std::vector<ObjectDetection> before = objects;
  scores_are_log_odds_ = !detector_.hasBackend();  // scores of boxes in a log are calibrated
  if (!scores_are_log_odds_) calibrateScores(detector_.setup(), objects);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto& o = objects[i];
    if (!o.image_box) continue;
    const bool calibrated = scores_are_log_odds_ || o.score != before[i].score;
    rows_ += fmt::format("{},{},{:.4f},{},{:.2f},{:.2f},{:.2f},{:.2f},{}\n", result.name, o.label,
                         result.raw[i],
                         calibrated ? fmt::format("{:.4f}", 1 / (1 + std::exp(-o.score))) : "",
                         o.image_box->x1, o.image_box->y1, o.image_box->x2, o.image_box->y2,
                         o.heading ? fmt::format("{:.2f}", degrees(*o.heading)) : "");
  }
  ++totals_.images;
  totals_.objects += static_cast<std::int64_t>(objects.size());
  if (!options_.kitti_folder.empty()) {
    std::string lines;
    for (const auto& o : objects) {
      if (o.image_box) lines += kittiBoxLine(o);
    }
    createFolder(options_.kitti_folder);
    writeFile((fs::path(options_.kitti_folder) / (fs::path(result.name).stem().string() + ".txt"))
                  .string(),
              lines);
  }
}

void DetectRun::readImages(const std::vector<std::string>& inputs) {
  if (!detector_.hasBackend())
    throw Error(ExitCode::kUsage, "backend file: boxes are taken from a log, -i FILE.rawlog");
  const std::vector<std::string> files = imageFiles(inputs);
  std::optional<ImageLabels> truth;
  if (!options_.labels.empty()) truth.emplace(options_.labels, options_.rules);
  std::optional<OutputFolder> folder;
  if (!options_.output.empty()) folder.emplace(options_.output);
  if (options_.pictures && !folder) throw Error(ExitCode::kUsage, "--pictures needs -o DIR");
  Progress progress("detect", files.size());
  for (const std::string& file : files) {
    stopIfAsked();
    const auto image = readImage(file);
    if (!image) {
      if (!fs::exists(file))
        throw DataError(fmt::format("{}: no such image", file), ExitCode::kNoInput);
      if (options_.strict) throw DataError(fmt::format("{}: not an image", file));
      ++totals_.unreadable;
      warn_(fmt::format("{}: not an image, left out", file));
      continue;
    }
    Result result;
    result.name = fs::path(file).filename().string();
    result.image = *image;
    CameraModel camera = cameraOf(*image, camera_, file);
    std::optional<Pose3> pose;
    if (camera_.height > 0) pose = cameraPose(camera_.height, camera_.pitch);
    if (!options_.calibrations.empty()) {
      camera = readKittiCalibration(
                   (fs::path(options_.calibrations) / (fs::path(file).stem().string() + ".txt"))
                       .string())
                   .camera;
      pose = cameraPose(camera_.height > 0 ? camera_.height : kKittiCameraHeight, camera_.pitch);
    }
    result.found = timed(*image, camera, pose);
    if (truth) result.truth = truth->of(result.name);
    finish(result);
    if (options_.pictures) draw(*folder, result);
    progress.update(static_cast<std::uint64_t>(totals_.images),
                    static_cast<std::uint64_t>(totals_.images));
  }
  if (truth) totals_.quality = quality_.results();
  if (!folder) return;
  writeResults(*folder);
  folder->commit("detections.csv");
}

std::string DetectRun::calibration() const {
  return calibrationIni(detector_.setup(), quality_, totals_.images, options_.overlap);
}

void DetectRun::draw(OutputFolder& folder, const Result& result) const {
  const auto& objects = result.found.objects;
  bool calibrated = false;
  for (std::size_t i = 0; i < objects.size(); ++i)
    calibrated = calibrated || objects[i].score != result.raw[i];
  writePicture(
      folder.pathFor("pictures/" + fs::path(result.name).stem().string() + ".png"),
      detectionPicture(result.image, objects, result.truth, calibrated || scores_are_log_odds_));
}

void DetectRun::writeResults(OutputFolder& folder) const {
  writeFile(folder.pathFor("detections.csv"), rows_);
  if (totals_.quality.empty()) return;
  writeFile(folder.pathFor("quality.csv"), qualityCsv(totals_.quality));
  writeFile(folder.pathFor("precision.csv"), precisionCsv(totals_.quality));
}

/// Output of a log's boxes: into another log, or as pictures and tables into a folder.
struct DetectRun::LogOutput {
  std::optional<RawlogWriter> writer;
  std::optional<OutputFolder> folder;
};

void DetectRun::openOutput(LogOutput& out) const {
  if (!options_.labels.empty())
    throw Error(ExitCode::kUsage, "--labels belong to images, not to a log");
  const bool to_log = !options_.output.empty() && isRawlog(options_.output);
  if (!to_log && !(options_.pictures && !options_.output.empty()))
    throw Error(ExitCode::kUsage, "-o FILE.rawlog is required, or --pictures -o DIR");
  if (to_log && !detector_.hasBackend())
    throw Error(ExitCode::kUsage, "backend file: the log has its boxes; --pictures -o DIR");
  if (to_log) {
    out.writer.emplace(options_.output);
  } else {
    out.folder.emplace(options_.output);
  }
}

void DetectRun::closeOutput(const std::string& images, LogOutput& out) const {
  if (out.writer) {
    out.writer->close();
    // Lets the new log refer to the external images of the old one.
    const fs::path beside = images, link = imagesBeside(options_.output);
    if (fs::is_directory(beside) && !fs::exists(fs::symlink_status(link)))
      fs::create_directory_symlink(fs::absolute(beside), link);
  }
  if (out.folder) {
    writeResults(*out.folder);
    out.folder->commit("detections.csv");
  }
}

void DetectRun::readLog(const std::string& log) {
  LogOutput out;
  openOutput(out);
  RawlogReader reader(log);
  Progress progress("detect", reader.fileBytes());
  std::optional<SensorFrame> shown, boxes;  // newest image and boxes, for the back end `file`
  std::int64_t seen = 0;
  const std::string images = imagesBeside(log);
  while (const auto observation = reader.next()) {
    stopIfAsked();
    if (out.writer) out.writer->write(*observation);
    std::optional<SensorFrame> frame;
    if (isImage(*observation)) frame = frameFromObservation(*observation, nullptr, images);
    const bool is_image =
        frame && (options_.camera_label.empty() || frame->sensor == options_.camera_label) &&
        seen++ % options_.every == 0;
    if (detector_.hasBackend()) {
      if (!is_image) continue;
      auto result = detectIn(*frame, seen - 1);
      if (!result) continue;
      finish(*result);
      if (out.writer) out.writer->write(*boxesObservation(*frame, result->found));
      if (out.folder) draw(*out.folder, *result);
    } else {
      if (is_image) shown = std::move(frame);
      const auto decoded = frameFromObservation(*observation);
      if (decoded && std::holds_alternative<ObjectDetections>(decoded->data) &&
          (options_.boxes_label.empty() || decoded->sensor == options_.boxes_label))
        boxes = decoded;
      if (!shown || !boxes || !(shown->stamp == boxes->stamp)) continue;
      if (auto result = detectIn(*shown, seen - 1)) {
        result->found = std::get<ObjectDetections>(boxes->data);
        finish(*result);
        draw(*out.folder, *result);
      }
      shown.reset();
    }
    progress.update(reader.bytesRead(), static_cast<std::uint64_t>(totals_.images));
  }
  if (reader.end() != RawlogReader::End::kClean) {
    if (options_.strict) throw DataError(reader.endMessage());
    warn_(reader.endMessage());
  }
  if (totals_.images == 0)
    throw DataError(
        fmt::format("{}: no image{} in it that can be read{}", log,
                    options_.camera_label.empty() ? "" : " labeled " + options_.camera_label,
                    detector_.hasBackend() ? "" : ", with boxes of the same time"));
  closeOutput(images, out);
}

std::optional<DetectRun::Result> DetectRun::detectIn(const SensorFrame& frame,
                                                     std::int64_t number) {
  const auto& data = std::get<CameraImage>(frame.data);
  auto image = data.load ? data.load() : std::nullopt;
  if (!image || image->width <= 0 || image->height <= 0) {
    if (options_.strict)
      throw DataError(fmt::format("{}: image is missing or damaged", data.source));
    if (totals_.unreadable++ == 0)
      warn_(fmt::format("{}: image is missing or damaged", data.source));
    return std::nullopt;
  }
  CameraModel camera = data.camera;
  if (isPanorama(*image, camera_.panorama, camera.fx > 0)) {
    camera = panoramaCamera(*image, camera_, data.source);
  } else if (camera.fx <= 0) {
    camera = cameraOf(*image, camera_, data.source);
  }
  Result result;
  result.name = fmt::format("{}_{:06}", frame.sensor, number);
  result.found = timed(*image, camera, frame.T_ego_sensor);
  result.image = std::move(*image);
  return result;
}

std::shared_ptr<mrpt::obs::CObservation> DetectRun::boxesObservation(
    const SensorFrame& image, const ObjectDetections& found) const {
  SensorFrame out = image;
  out.sensor = options_.boxes_label.empty() ? image.sensor + "_BOXES" : options_.boxes_label;
  ObjectDetections boxes = found;
  boxes.T_ego_camera.reset();  // the sensor's frame is the camera's
  out.data = std::move(boxes);
  return observationFromFrame(out);
}

}  // namespace perception
