#include "libperception/app/ImportApp.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>

namespace perception {

std::string ImportApp::description() const {
  return "Turns recordings of other formats into a rawlog and, with labels, FILE.truth.csv beside "
         "it.";
}

void ImportApp::declare(CLI::App& cli) {
  cli.require_subcommand(1);
  CLI::App& sub = *cli.add_subcommand("kitti", "one sequence of the KITTI tracking benchmark");
  sub.add_option("--calib", kitti.calibration, "calibration file (P2, R0_rect, Tr_velo_to_cam)")
      ->required();
  auto* poses = sub.add_option("--poses", kitti.poses, "ego poses, one line a frame");
  sub.add_option("--poses-frame", kitti.poses_frame, "whose poses they are")
      ->check(CLI::IsMember({"velodyne", "camera", "imu"}))
      ->capture_default_str();
  sub.add_option("--poses-format", kitti.poses_format,
                 "kitti: 12 numbers (3x4); tum: t x y z qx qy qz qw")
      ->check(CLI::IsMember({"kitti", "tum"}))
      ->capture_default_str();
  sub.add_option("--oxts", kitti.oxts, "GPS/IMU file, instead of --poses")->excludes(poses);
  sub.add_option("--lidar", kitti.lidar_dir, "folder of Velodyne scans, FRAME.bin or FRAME.bin.gz");
  sub.add_option("--labels", kitti.labels, "truth: tracking labels");
  sub.add_option("--images", kitti.images_dir,
                 "folder of left colour images, FRAME.png or FRAME.jpg");
  sub.add_flag("--embed-images", kitti.embed_images,
               "images as JPEG inside the log, not in FILE_Images beside it");
  sub.add_option("--detections", detections,
                 "NAME:CLASS=FILE, repeatable; NAME: pointrcnn, pointgnn, rrc, dpm, kitti3d, "
                 "kitti2d (or one of them and "
                 "-anything); CLASS: rows of this type, or all");
  sub.add_option("--rate", kitti.rate, "[Hz] of the frames; the cars' true rate was 9.66")
      ->capture_default_str();
  sub.add_option("--first", kitti.first, "first frame")->capture_default_str();
  sub.add_option("--last", kitti.last, "last frame; -1: the last pose")->capture_default_str();
  addOutputOption(sub, true);
}

void ImportApp::parseDetections() {
  for (const std::string& text : detections) {
    const auto colon = text.find(':');
    const auto equals = text.find('=', colon == std::string::npos ? 0 : colon);
    if (colon == std::string::npos || equals == std::string::npos || colon == 0 ||
        equals <= colon + 1 || equals + 1 == text.size()) {
      throw Error(ExitCode::kUsage,
                  fmt::format("--detections '{}': expected NAME:CLASS=FILE", text));
    }
    kitti.detections.push_back({text.substr(0, colon), text.substr(colon + 1, equals - colon - 1),
                                text.substr(equals + 1)});
  }
}

void ImportApp::run() {
  parseDetections();
  kitti.output = output;
  std::optional<Progress> progress;
  out_result = importKitti(kitti, [&progress](std::int64_t done, std::int64_t total) {
    stopIfAsked();
    if (!progress) progress.emplace("import", static_cast<std::uint64_t>(total));
    progress->update(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(done));
  });
  progress.reset();
  for (const std::string& warning : out_result.warnings) warn(warning);
  report();
}

void ImportApp::report() const {
  const KittiImportResult& r = out_result;
  fmt::print("{}: {} frames, {} entries, {:.2f} MB ({:.2f} MB inflated)\n", output, r.frames,
             r.entries, static_cast<double>(r.bytes) * 1e-6,
             static_cast<double>(r.bytes_inflated) * 1e-6);
  if (!kitti.lidar_dir.empty()) fmt::print("  lidar: {} scans, {} points\n", r.scans, r.points);
  for (const auto& [detector, count] : r.detections)
    fmt::print("  {}: {} detections\n", detector, count);
  if (!kitti.images_dir.empty()) fmt::print("  images: {}\n", r.images);
  if (r.truth_file.empty()) return;
  fmt::print("{}: {} rows\n", r.truth_file, r.truth_rows);
  for (const auto& [type, count] : r.truth_types) fmt::print("  {}: {}\n", type, count);
}

}  // namespace perception
