#include "libperception/app/detect/DetectApp.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>

#include "libperception/app/Programs.h"
#include "libperception/detection/DetectResults.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

void DetectApp::declare(CLI::App& cli) {
  addConfigOptions(cli, false);
  cli.add_option("-i,--input", inputs, "Images, folders of images, or one log");
  addOutputOption(cli, false);
  cli.add_option("--labels", options.labels, "Truth: a folder of KITTI's object labels, or a CSV");
  cli.add_option("--calib", options.calibrations, "Folder of KITTI calibrations (NAME.txt)");
  cli.add_option("--camera", options.camera_label,
                 "sensorLabel of the log's images; default: all images");
  cli.add_option("--label", options.boxes_label, "sensorLabel of the boxes; default: IMAGES_BOXES");
  cli.add_option("--calibrate", calibrate,
                 "Fit P(object | score) to the labels and write this INI");
  cli.add_option("--export", kitti_export,
                 "kitti:DIR: also write one file per image in KITTI's layout");
  cli.add_flag("--pictures", options.pictures, "Draw the boxes: pictures/NAME.png");
  cli.add_option("--every", options.every, "Use one in so many of a log's images")
      ->check(CLI::Range(1, 100000));
  cli.add_option("--overlap", options.overlap, "Least intersection over union of a right box")
      ->check(CLI::Range(0.1, 1.0))
      ->capture_default_str();
  cli.add_option("--min-height", options.rules.min_height,
                 "Labels lower than so many pixels do not count")
      ->capture_default_str();
  cli.add_option("--max-truncation", options.rules.max_truncation,
                 "Labels of which a larger share is cut off do not count")
      ->capture_default_str();
  cli.add_option("--max-occlusion", options.rules.max_occlusion,
                 "Labels that are hidden more do not count (KITTI: 0-3)")
      ->capture_default_str();
  addRunOptions(cli);
}

void DetectApp::run() {
  if (config_file.empty()) throw Error(ExitCode::kUsage, "-c INI is required: ini/detectors");
  Config config = loadConfig();
  DetectorSetup setup = DetectorSetup::read(config);
  const auto camera = config.read<DetectCameraParams>("camera");
  if (configDone(config)) return;
  if (inputs.empty()) throw Error(ExitCode::kUsage, "-i is required: images, a folder or a log");
  if (!kitti_export.empty()) {
    if (kitti_export.rfind("kitti:", 0) != 0)
      throw Error(ExitCode::kUsage, "--export: expected kitti:DIR");
    options.kitti_folder = kitti_export.substr(6);
  }
  if (!calibrate.empty() && options.labels.empty())
    throw Error(ExitCode::kUsage, "--calibrate needs --labels");
  // Threads of the detectors; results do not depend on their number.
  std::optional<tbb::global_control> limit;
  if (threads > 0)
    limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  cv::setNumThreads(threads > 0 ? threads : -1);
  const ImageDetector detector(std::move(setup));
  options.output = output;
  options.strict = strict;
  DetectRun run(detector, camera, options, [this](const std::string& text) { warn(text); });
  if (isRawlog(inputs.front())) {
    if (inputs.size() > 1) throw Error(ExitCode::kUsage, "one log at a time");
    run.readLog(inputs.front());
  } else {
    run.readImages(inputs);
  }
  out = run.totals();
  if (!calibrate.empty()) {
    writeFile(calibrate, run.calibration());
    fmt::print("{}: calibration of {} images\n", calibrate, out.images);
  }
  fmt::print("{} images, {} boxes; {:.1f} ms an image\n{}", out.images, out.objects,
             out.images > 0 ? 1e3 * out.seconds / static_cast<double>(out.images) : 0.0,
             qualityText(out.quality));
}

std::unique_ptr<App> detectApp() { return std::make_unique<DetectApp>(); }

}  // namespace perception
