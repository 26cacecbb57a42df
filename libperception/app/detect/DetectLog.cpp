#include <fmt/format.h>

#include <filesystem>

#include "libperception/app/detect/DetectApp.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception {

namespace fs = std::filesystem;

/// Output of a log's boxes: into another log, or as pictures and tables into a folder.
struct DetectApp::LogOutput {
  std::optional<RawlogWriter> writer;
  std::optional<OutputFolder> folder;
};

void DetectApp::openOutput(bool detects, LogOutput& out) const {
  if (!labels.empty()) throw Error(ExitCode::kUsage, "--labels belong to images, not to a log");
  const bool to_log = !output.empty() && isRawlog(output);
  if (!to_log && !(pictures && !output.empty()))
    throw Error(ExitCode::kUsage, "-o FILE.rawlog is required, or --pictures -o DIR");
  if (to_log && !detects)
    throw Error(ExitCode::kUsage, "backend file: the log has its boxes; --pictures -o DIR");
  if (to_log) {
    out.writer.emplace(output);
  } else {
    out.folder.emplace(output);
  }
}

void DetectApp::closeOutput(const std::string& images, LogOutput& out) const {
  if (out.writer) {
    out.writer->close();
    // Lets the new log refer to the external images of the old one.
    const fs::path beside = images, link = imagesBeside(output);
    if (fs::is_directory(beside) && !fs::exists(fs::symlink_status(link)))
      fs::create_directory_symlink(fs::absolute(beside), link);
  }
  if (out.folder) {
    writeResults(&*out.folder);
    out.folder->commit("detections.csv");
  }
}

void DetectApp::runLog(const ImageDetector& detector, const DetectCameraParams& params,
                       const std::string& log) {
  LogOutput out;
  openOutput(detector.hasBackend(), out);
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
        frame && (camera_label.empty() || frame->sensor == camera_label) && seen++ % every == 0;
    if (detector.hasBackend()) {
      if (!is_image) continue;
      auto result = detectIn(*frame, seen - 1, detector, params);
      if (!result) continue;
      finish(detector, *result);
      if (out.writer) out.writer->write(*boxesObservation(*frame, result->found));
      if (out.folder) draw(*out.folder, *result);
    } else {
      if (is_image) shown = std::move(frame);
      const auto decoded = frameFromObservation(*observation);
      if (decoded && std::holds_alternative<ObjectDetections>(decoded->data) &&
          (boxes_label.empty() || decoded->sensor == boxes_label))
        boxes = decoded;
      if (!shown || !boxes || !(shown->stamp == boxes->stamp)) continue;
      if (auto result = detectIn(*shown, seen - 1, detector, params)) {
        result->found = std::get<ObjectDetections>(boxes->data);
        detector.addHeadings(result->image, result->found.camera, result->found.objects);
        finish(detector, *result);
        draw(*out.folder, *result);
      }
      shown.reset();
    }
    progress.update(reader.bytesRead(), static_cast<std::uint64_t>(out_images));
  }
  if (reader.end() != RawlogReader::End::kClean) {
    if (strict) throw DataError(reader.endMessage());
    warn(reader.endMessage());
  }
  if (out_images == 0)
    throw DataError(fmt::format("{}: no image{} in it that can be read{}", log,
                                camera_label.empty() ? "" : " labeled " + camera_label,
                                detector.hasBackend() ? "" : ", with boxes of the same time"));
  closeOutput(images, out);
}

std::optional<DetectApp::Result> DetectApp::detectIn(const SensorFrame& frame, std::int64_t number,
                                                     const ImageDetector& detector,
                                                     const DetectCameraParams& params) {
  const auto& data = std::get<CameraImage>(frame.data);
  auto image = data.load ? data.load() : std::nullopt;
  if (!image || image->width <= 0 || image->height <= 0) {
    if (strict) throw DataError(fmt::format("{}: image is missing or damaged", data.source));
    if (out_unreadable++ == 0) warn(fmt::format("{}: image is missing or damaged", data.source));
    return std::nullopt;
  }
  CameraModel camera = data.camera;
  if (isPanorama(*image, params.panorama, camera.fx > 0)) {
    camera = panoramaCamera(*image, params, data.source);
  } else if (camera.fx <= 0) {
    camera = cameraOf(*image, params, data.source);
  }
  Result result;
  result.name = fmt::format("{}_{:06}", frame.sensor, number);
  result.found = timed(detector, *image, camera, frame.T_ego_sensor);
  result.image = std::move(*image);
  return result;
}

std::shared_ptr<mrpt::obs::CObservation> DetectApp::boxesObservation(
    const SensorFrame& image, const ObjectDetections& found) const {
  SensorFrame out = image;
  out.sensor = boxes_label.empty() ? image.sensor + "_BOXES" : boxes_label;
  ObjectDetections boxes = found;
  boxes.T_ego_camera.reset();  // the sensor's frame is the camera's
  out.data = std::move(boxes);
  return observationFromFrame(out);
}

}  // namespace perception
