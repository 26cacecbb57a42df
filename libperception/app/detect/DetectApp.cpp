#include "libperception/app/detect/DetectApp.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>

#include "libperception/app/Programs.h"
#include "libperception/app/detect/DetectResults.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/pictures/DetectPicture.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/sensors/images/CameraImages.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr double kKittiCameraHeight = 1.65;  // [m] kitti.com/setup: cameras above the ground

}  // namespace

std::string DetectApp::description() const {
  return "Finds cars and people in images, or in the images of a log; compares with labels.";
}

void DetectApp::declare(CLI::App& cli) {
  addConfigOptions(cli, false);
  cli.add_option("-i,--input", inputs, "Images, folders of images, or one log");
  addOutputOption(cli, false);
  cli.add_option("--labels", labels, "Truth: a folder of KITTI's object labels, or a CSV");
  cli.add_option("--calib", calibrations, "Folder of KITTI calibrations (NAME.txt)");
  cli.add_option("--camera", camera_label, "sensorLabel of the log's images; default: all images");
  cli.add_option("--label", boxes_label, "sensorLabel of the boxes; default: IMAGES_BOXES");
  cli.add_option("--calibrate", calibrate,
                 "Fit P(object | score) to the labels and write this INI");
  cli.add_option("--export", kitti_folder,
                 "kitti:DIR: also write one file per image in KITTI's layout");
  cli.add_option("--train-heading", train_heading,
                 "Learn the headings of boxes from images and --labels, and write this file");
  cli.add_option("--heading-label", heading_label, "Class of the boxes to learn from")
      ->capture_default_str();
  cli.add_flag("--pictures", pictures, "Draw the boxes: pictures/NAME.png");
  cli.add_option("--every", every, "Use one in so many of a log's images")
      ->check(CLI::Range(1, 100000));
  cli.add_option("--overlap", overlap, "Least intersection over union of a right box")
      ->check(CLI::Range(0.1, 1.0))
      ->capture_default_str();
  cli.add_option("--min-height", min_height, "Labels lower than so many pixels do not count")
      ->capture_default_str();
  cli.add_option("--max-truncation", max_truncation,
                 "Labels of which a larger share is cut off do not count")
      ->capture_default_str();
  cli.add_option("--max-occlusion", max_occlusion,
                 "Labels that are hidden more do not count (KITTI: 0-3)")
      ->capture_default_str();
  addRunOptions(cli);
}

void DetectApp::run() {
  if (!train_heading.empty()) return trainHeading();
  if (config_file.empty()) throw Error(ExitCode::kUsage, "-c INI is required: ini/detectors");
  Config config = loadConfig();
  DetectorSetup setup = DetectorSetup::read(config);
  const auto camera = config.read<DetectCameraParams>("camera");
  if (configDone(config)) return;
  if (inputs.empty()) throw Error(ExitCode::kUsage, "-i is required: images, a folder or a log");
  if (!kitti_folder.empty()) {
    if (kitti_folder.rfind("kitti:", 0) != 0)
      throw Error(ExitCode::kUsage, "--export: expected kitti:DIR");
    kitti_folder = kitti_folder.substr(6);
  }
  if (!calibrate.empty() && labels.empty())
    throw Error(ExitCode::kUsage, "--calibrate needs --labels");
  quality_ = DetectionQuality(overlap, min_height);
  rows_ = "image,label,score,probability,x1,y1,x2,y2,heading_deg\n";
  out_images = out_objects = out_unreadable = 0;
  out_seconds = 0;
  // Threads of the detectors; results do not depend on their number.
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  cv::setNumThreads(threads > 0 ? threads : -1);
  const ImageDetector detector(std::move(setup));
  if (isRawlog(inputs.front())) {
    if (inputs.size() > 1) throw Error(ExitCode::kUsage, "one log at a time");
    runLog(detector, camera, inputs.front());
  } else {
    runImages(detector, camera);
  }
  report();
}

ObjectDetections DetectApp::timed(const ImageDetector& detector, const Raster& image,
                                  const CameraModel& camera, const std::optional<Pose3>& pose) {
  const auto start = std::chrono::steady_clock::now();
  auto found = detector.detect(image, camera, pose);
  out_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

void DetectApp::finish(const ImageDetector& detector, Result& result) {
  if (!labels.empty()) quality_.add(result.truth, result.found.objects);
  auto& objects = result.found.objects;
  for (const ObjectDetection& o : objects) result.raw.push_back(o.score);
  std::vector<ObjectDetection> before = objects;
  scores_are_log_odds_ = !detector.hasBackend();  // scores of boxes in a log are calibrated
  if (!scores_are_log_odds_) calibrateScores(detector.setup(), objects);
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
  ++out_images;
  out_objects += static_cast<std::int64_t>(objects.size());
  if (!kitti_folder.empty()) {
    std::string lines;
    for (const auto& o : objects) {
      if (o.image_box) lines += kittiBoxLine(o);
    }
    createFolder(kitti_folder);
    writeFile((fs::path(kitti_folder) / (fs::path(result.name).stem().string() + ".txt")).string(),
              lines);
  }
}

void DetectApp::runImages(const ImageDetector& detector, const DetectCameraParams& params) {
  if (!detector.hasBackend())
    throw Error(ExitCode::kUsage, "backend file: boxes are taken from a log, -i FILE.rawlog");
  const std::vector<std::string> files = imageFiles(inputs);
  std::optional<ImageLabels> truth;
  if (!labels.empty()) truth.emplace(labels, LabelRules{min_height, max_truncation, max_occlusion});
  std::optional<OutputFolder> folder;
  if (!output.empty()) folder.emplace(output);
  if (pictures && !folder) throw Error(ExitCode::kUsage, "--pictures needs -o DIR");
  Progress progress("detect", files.size());
  for (const std::string& file : files) {
    stopIfAsked();
    const auto image = readImage(file);
    if (!image) {
      if (!fs::exists(file))
        throw DataError(fmt::format("{}: no such image", file), ExitCode::kNoInput);
      if (strict) throw DataError(fmt::format("{}: not an image", file));
      ++out_unreadable;
      warn(fmt::format("{}: not an image, left out", file));
      continue;
    }
    Result result;
    result.name = fs::path(file).filename().string();
    result.image = *image;
    CameraModel camera = cameraOf(*image, params, file);
    std::optional<Pose3> pose;
    if (params.height > 0) pose = cameraPose(params.height, params.pitch);
    if (!calibrations.empty()) {
      camera = readKittiCalibration(
                   (fs::path(calibrations) / (fs::path(file).stem().string() + ".txt")).string())
                   .camera;
      pose = cameraPose(params.height > 0 ? params.height : kKittiCameraHeight, params.pitch);
    }
    result.found = timed(detector, *image, camera, pose);
    if (truth) result.truth = truth->of(result.name);
    finish(detector, result);
    if (pictures) draw(*folder, result);
    progress.update(static_cast<std::uint64_t>(out_images), static_cast<std::uint64_t>(out_images));
  }
  if (truth) out_quality = quality_.results();
  writeResults(folder ? &*folder : nullptr);
  if (folder) folder->commit("detections.csv");
  if (calibrate.empty()) return;
  writeFile(calibrate, calibrationIni(detector.setup(), quality_, out_images, overlap));
  fmt::print("{}: calibration of {} images\n", calibrate, out_images);
}

void DetectApp::draw(OutputFolder& folder, const Result& result) const {
  const auto& objects = result.found.objects;
  bool calibrated = false;
  for (std::size_t i = 0; i < objects.size(); ++i)
    calibrated = calibrated || objects[i].score != result.raw[i];
  writePicture(
      folder.pathFor("pictures/" + fs::path(result.name).stem().string() + ".png"),
      detectionPicture(result.image, objects, result.truth, calibrated || scores_are_log_odds_));
}

void DetectApp::writeResults(OutputFolder* folder) const {
  if (folder == nullptr) return;
  writeFile(folder->pathFor("detections.csv"), rows_);
  if (out_quality.empty()) return;
  writeFile(folder->pathFor("quality.csv"), qualityCsv(out_quality));
  writeFile(folder->pathFor("precision.csv"), precisionCsv(out_quality));
}

void DetectApp::report() const {
  fmt::print("{} images, {} boxes; {:.1f} ms an image\n", out_images, out_objects,
             out_images > 0 ? 1e3 * out_seconds / static_cast<double>(out_images) : 0.0);
  for (const LabelQuality& q : out_quality) {
    if (q.labeled == 0) continue;
    fmt::print("{:12} AP {:.3f}  recall {:.3f}  ({} labeled, {} right, {} wrong)", q.label,
               q.average_precision, q.recall, q.labeled, q.right, q.wrong);
    if (q.headings > 0)
      fmt::print("; heading: median {:.1f} deg, rms {:.1f} deg, {} flips of {}",
                 degrees(q.heading_median), degrees(q.heading_rms), q.flips, q.headings);
    fmt::print("\n");
  }
}

std::unique_ptr<App> detectApp() { return std::make_unique<DetectApp>(); }

}  // namespace perception
