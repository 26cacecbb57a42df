#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/kitti/KittiLabels.h"
#include "libperception/importers/street_sets/VodFiles.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

/// [m] Height of the level lidar above the plane of the poses: z of odomToCamera * Tr_velo_to_cam
/// (1.6501); road returns of the example frames lie 1.6 m below it.
constexpr double kLidarHeight = 1.65;
/// [s] before and after an isolated frame: poses that give the ego velocity.
constexpr double kVelocityStep = 0.1;

/// Where the parts of a recording lie: in the example set, in the whole data set.
struct Part {
  const char *example, *whole;
};
constexpr Part kLidar{"lidar_points", "lidar/training/velodyne"};
constexpr Part kRadar{"radar_points", "radar/training/velodyne"};
constexpr Part kLidarCalibration{"calib_lidar", "lidar/training/calib"};
constexpr Part kRadarCalibration{"calib_radar", "radar/training/calib"};
constexpr Part kImages{"image_2", "lidar/training/image_2"};
constexpr Part kLabels{"label_2", "lidar/training/label_2"};
constexpr Part kPoses{"pose", "lidar/training/pose"};

/// A label's box in the lidar's frame: its rotation turns about the lidar's -z axis.
ObjectDetection::SpaceBox boxOf(const KittiBox& box, const Pose3& T_lidar_camera) {
  ObjectDetection::SpaceBox out;
  out.bottom_center = T_lidar_camera * box.bottom_center;
  out.yaw = wrapAngle(-box.rotation_y - kPi / 2);
  out.length = box.length;
  out.width = box.width;
  out.height = box.height;
  return out;
}

/// View of Delft: a folder in the layout of the example set or of the whole data set.
class VodImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_, "folder with lidar_points/ ... or with lidar/training/ ...")
        ->required();
  }
  void run(ImportLog& log) override;

 private:
  struct Frame {
    std::int64_t number = 0;
    bool alone = false;  ///< no frame just before it and none just after
    KittiCalibration calibration;
    Pose3 T_cam_radar = Pose3::Identity();
    std::optional<Pose3> T_odom_camera;
    std::optional<LidarCloud> cloud;
    std::vector<VodRadarPoint> radar;
    bool has_radar = false;
    std::vector<KittiLabel> labels;
    std::string image;
  };
  std::string folder(const Part& part) const;  ///< empty: not there
  std::string file(const Part& part, const FrameFile& frame,
                   const std::vector<std::string>& endings) const;
  Frame read(const FrameFile& file, ImportLog& log) const;
  Pose3 egoOf(const Frame& frame) const;
  void write(const Frame& frame, Stamp stamp, bool still, bool last, ImportLog& log) const;
  void writeTruth(const Frame& frame, Stamp stamp, const Pose3& T_world_lidar,
                  ImportLog& log) const;

  std::string dir_;
  Pose3 T_ego_lidar_ = makePose(0, 0, kLidarHeight, 0);
  std::optional<Pose3> T_world_odom_;
};

std::string VodImporter::folder(const Part& part) const {
  for (const char* name : {part.example, part.whole}) {
    const fs::path path = fs::path(dir_) / name;
    if (fs::is_directory(path)) return path.string();
  }
  return {};
}

std::string VodImporter::file(const Part& part, const FrameFile& frame,
                              const std::vector<std::string>& endings) const {
  const std::string dir = folder(part);
  return dir.empty() ? dir : fileOfStem(dir, frame.stem, endings);
}

VodImporter::Frame VodImporter::read(const FrameFile& f, ImportLog& log) const {
  Frame frame;
  frame.number = f.number;
  const auto need = [&](const Part& part) {
    const std::string path = file(part, f, {".txt"});
    if (path.empty()) {
      throw DataError(fmt::format("{}: no {}/{}.txt, the calibration of {}", dir_, part.example,
                                  f.stem, f.path),
                      ExitCode::kNoInput);
    }
    return readKittiCalibration(path);
  };
  frame.calibration = need(kLidarCalibration);
  const auto optional = [&](const Part& part, const char* what,
                            const std::vector<std::string>& endings) {
    const std::string path = file(part, f, endings);
    if (path.empty() && !folder(part).empty()) log.missing(what, folder(part), f.number);
    return path;
  };
  const std::string scan = optional(kLidar, "scan", {".bin", ".bin.gz"});
  CloudFormat format;
  format.intensity_max = 255;
  format.max_range = 120;  // [m] HDL-64E, data sheet
  if (!scan.empty()) frame.cloud = readCloudFile(scan, format);
  const std::string radar = optional(kRadar, "radar scan", {".bin", ".bin.gz"});
  if (!radar.empty()) {
    frame.T_cam_radar = need(kRadarCalibration).T_cam0_velo;
    frame.radar = readVodRadar(radar);
    frame.has_radar = true;
  }
  const std::string pose = optional(kPoses, "pose", {".json"});
  if (!pose.empty()) frame.T_odom_camera = readVodPose(pose);
  const std::string labels = optional(kLabels, "labels", {".txt"});
  if (!labels.empty()) frame.labels = readKittiObjectLabels(labels, f.number);
  frame.image = optional(kImages, "image", {".jpg", ".png"});
  return frame;
}

Pose3 VodImporter::egoOf(const Frame& frame) const {
  if (!frame.T_odom_camera || !T_world_odom_) return Pose3::Identity();
  return *T_world_odom_ * *frame.T_odom_camera * frame.calibration.T_cam0_velo *
         T_ego_lidar_.inverse();
}

void VodImporter::writeTruth(const Frame& frame, Stamp stamp, const Pose3& T_world_lidar,
                             ImportLog& log) const {
  const Pose3 T_lidar_camera = frame.calibration.T_cam0_velo.inverse();
  for (const KittiLabel& label : frame.labels) {
    if (!label.box) continue;
    TruthObject o;
    o.frame = frame.number;
    // The published labels have no ids: one for each frame and line.
    o.id = frame.number * 1000 + label.id;
    o.type = label.type == "truck" ? "Truck" : label.type;
    o.occluded = std::max(0, label.occluded);
    o.ignore = !coveredType(o.type);  // riders stand in a Cyclist's box; parked two-wheelers
    const ObjectDetection::SpaceBox box = boxOf(*label.box, T_lidar_camera);
    placeTruth(box, T_world_lidar, o);
    if (frame.cloud) o.lidar_points = returnsInside(box, *frame.cloud);
    log.truth(stamp, std::move(o));
  }
}

void VodImporter::write(const Frame& frame, Stamp stamp, bool still, bool last,
                        ImportLog& log) const {
  const Pose3 T_world_ego = egoOf(frame);
  const Pose3 T_ego_camera = T_ego_lidar_ * frame.calibration.T_cam0_velo.inverse();
  const Pose3 T_ego_radar = T_ego_camera * frame.T_cam_radar;
  const bool has_ego = still || frame.T_odom_camera;
  const bool carries = !still && frame.alone && frame.has_radar && has_ego;
  Vector3 step = Vector3::Zero();  // [m] on the road, world
  if (carries) {
    const Vector2 v = ownVelocity(frame.radar);
    step = kVelocityStep * (T_world_ego.linear() * T_ego_radar.linear() * Vector3(v.x(), v.y(), 0));
    step.z() = 0;
  }
  const auto ego = [&](double steps) {
    Pose3 pose = T_world_ego;
    pose.translation() += steps * step;
    log.ego(stamp + steps * kVelocityStep, pose);
  };
  if (carries) ego(-1);
  if (has_ego) ego(0);
  if (last) log.frame(stamp, frame.number);  // of a frame that is shown repeatedly
  if (frame.cloud) log.sensor(kLidarTop, stamp, T_ego_lidar_, *frame.cloud);
  if (frame.has_radar) log.sensor(kRadarFront, stamp, T_ego_radar, returnsOf(frame.radar, still));
  if (last && !frame.image.empty())
    log.image({kCameraFront, frame.image, stamp, frame.calibration.camera, T_ego_camera},
              frame.number);
  if (last) writeTruth(frame, stamp, T_world_ego * T_ego_lidar_, log);
  if (carries) ego(1);
}

void VodImporter::run(ImportLog& log) {
  requireFolder(dir_);
  const std::string scans = folder(kLidar).empty() ? folder(kRadar) : folder(kLidar);
  if (scans.empty()) {
    throw DataError(fmt::format("{}: neither {}/ nor {}/, expected a View-of-Delft folder", dir_,
                                kLidar.example, kLidar.whole),
                    ExitCode::kNoInput);
  }
  if (!folder(kLabels).empty()) log.expectTruth();
  const auto files = frameFiles(scans, {".bin", ".bin.gz"});
  std::int64_t done = 0, carried = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!log.wants(files[i].number)) continue;
    Frame frame = read(files[i], log);
    frame.alone = (i == 0 || files[i].number - files[i - 1].number > 2) &&
                  (i + 1 == files.size() || files[i + 1].number - files[i].number > 2);
    if (!T_world_odom_ && frame.T_odom_camera) {
      T_world_odom_ =
          T_ego_lidar_ * (*frame.T_odom_camera * frame.calibration.T_cam0_velo).inverse();
    }
    const Stamp stamp = stampAtRate(kUndatedStart, files[i].number, log.options().rate);
    const int repeat = log.options().repeat;
    const bool still = repeat > 1;
    const Stamp end = stampAtRate(stamp, repeat - 1, kRepeatRate);
    if (still) log.ego(stamp + -kStillPoses, egoOf(frame));
    for (int k = 0; k < repeat; ++k)
      write(frame, stampAtRate(stamp, k, kRepeatRate), still, k + 1 == repeat, log);
    if (still) log.ego(end + kStillPoses, egoOf(frame));
    if (repeat == 1 && frame.alone && frame.has_radar) ++carried;
    log.progress(++done, static_cast<std::int64_t>(files.size()));
  }
  if (carried > 0) {
    log.note(fmt::format("{} frames stand alone: their velocity is that of the radar's two rates",
                         carried));
  }
}

}  // namespace

std::unique_ptr<Importer> makeVodImporter() { return std::make_unique<VodImporter>(); }

}  // namespace perception
