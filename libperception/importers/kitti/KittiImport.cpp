#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/kitti/KittiDetections.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/importers/kitti/KittiLabels.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kScanEndings = {".bin", ".bin.gz"};
const std::vector<std::string> kImageEndings = {".png", ".jpg", ".jpeg"};

/// Inputs of a KITTI tracking sequence.
struct KittiImportParams {
  std::string calibration;               ///< calibration file
  std::string poses;                     ///< ego motion, one line per frame ...
  std::string poses_frame = "velodyne";  ///< ... of velodyne, camera or imu
  std::string poses_format = "kitti";    ///< ... kitti or tum
  std::string oxts;                      ///< instead of poses
  std::string lidar_dir, images_dir;     ///< empty: none
  std::string labels;                    ///< truth; empty: none
  std::vector<std::string> detections;   ///< NAME:CLASS=FILE
};

/// The whole import of one sequence.
class Import {
 public:
  Import(const KittiImportParams& params, ImportLog& log)
      : params_(params), options_(log.options()), log_(log) {}
  void run();

 private:
  void checkParams() const;
  void readAll();
  void readPoses();
  void framesOfFiles();
  bool hasPoses() const { return !params_.poses.empty() || !params_.oxts.empty(); }
  Stamp stampOf(std::int64_t frame) const;
  Pose3 egoAt(std::int64_t frame) const;
  Pose3 posesVelodyneAt(std::int64_t frame) const;
  void writeFrame(std::int64_t frame);
  std::optional<LidarCloud> readScan(std::int64_t frame);
  void writeImage(std::int64_t frame);
  void addTruth(std::int64_t frame, const std::optional<LidarCloud>& cloud);

  const KittiImportParams& params_;
  const ImportOptions& options_;
  ImportLog& log_;
  KittiCalibration calibration_;
  Pose3 T_ego_velo_ = makePose(0, 0, kKittiVelodyneHeight, 0);
  Pose3 T_ego_pose_ = Pose3::Identity();  ///< of the frame that the poses are of
  std::vector<Pose3> poses_;              ///< of that frame, in the frame of the file
  std::int64_t last_ = 0;
  KittiDetections detections_;
  std::map<std::int64_t, std::vector<KittiLabel>> labels_;
};

void Import::checkParams() const {
  if (!params_.poses.empty() && !params_.oxts.empty())
    failUsage("give --poses or --oxts, not both");
  if (!hasPoses() && params_.lidar_dir.empty() && params_.images_dir.empty())
    failUsage("give either --poses or --oxts, or --lidar or --images, which count the frames");
  if (!hasPoses() && !params_.labels.empty())
    failUsage("--labels needs --poses or --oxts: the truth is written in the world frame");
  for (const auto* dir : {&params_.lidar_dir, &params_.images_dir}) {
    if (!dir->empty()) requireFolder(*dir);
  }
}

void Import::readPoses() {
  const std::string frame = params_.oxts.empty() ? params_.poses_frame : "imu";
  if (frame == "camera") {
    T_ego_pose_ = T_ego_velo_ * calibration_.T_cam0_velo.inverse();
  } else if (frame == "imu") {
    if (!calibration_.T_velo_imu) {
      throw DataError(fmt::format("{}: no line Tr_imu_to_velo, needed for poses of the IMU",
                                  params_.calibration));
    }
    T_ego_pose_ = T_ego_velo_ * *calibration_.T_velo_imu;
  } else if (frame == "velodyne") {
    T_ego_pose_ = T_ego_velo_;
  } else {
    failUsage("--poses-frame must be velodyne, camera or imu");
  }
  if (params_.poses_format != "kitti" && params_.poses_format != "tum")
    failUsage("--poses-format must be kitti or tum");
  poses_ = params_.oxts.empty() ? readKittiPoses(params_.poses, params_.poses_format)
                                : readKittiOxts(params_.oxts);
  const auto end = static_cast<std::int64_t>(poses_.size());
  last_ = options_.last < 0 ? end - 1 : options_.last;
  if (options_.first >= end || last_ >= end) {
    throw DataError(fmt::format("{}: {} poses (frames 0 to {}), but frames {} to {} are wanted",
                                params_.oxts.empty() ? params_.poses : params_.oxts, end, end - 1,
                                options_.first, last_));
  }
}

/// Without poses the scans and images say which frames there are.
void Import::framesOfFiles() {
  std::int64_t newest = -1;
  const auto look = [&newest](const std::string& dir, const std::vector<std::string>& endings) {
    if (!dir.empty()) newest = std::max(newest, frameFiles(dir, endings).back().number);
  };
  look(params_.lidar_dir, kScanEndings);
  look(params_.images_dir, kImageEndings);
  last_ = options_.last < 0 ? newest : options_.last;
  log_.note(
      "no --poses and no --oxts: the log has no poses; [ego] source = lidar finds them in the "
      "scans");
}

void Import::readAll() {
  calibration_ = readKittiCalibration(params_.calibration);
  if (hasPoses()) {
    readPoses();
  } else {
    framesOfFiles();
  }
  for (const auto& wanted : params_.detections) detections_.add(wanted);
  if (detections_.needPoses() && !hasPoses())
    failUsage("--detections in nuScenes' format need --poses or --oxts, in whose frame they are");
  if (!params_.labels.empty()) {
    for (auto& label : readKittiLabels(params_.labels))
      labels_[label.frame].push_back(std::move(label));
  }
}

Stamp Import::stampOf(std::int64_t frame) const {
  return stampAtRate(kUndatedStart, frame, options_.rate);
}

Pose3 Import::egoAt(std::int64_t frame) const {
  const Pose3 moved = poses_.front().inverse() * poses_[static_cast<std::size_t>(frame)];
  return T_ego_pose_ * moved * T_ego_pose_.inverse();
}

/// Pose of the Velodyne in the frame of the file of poses; without poses identity.
Pose3 Import::posesVelodyneAt(std::int64_t frame) const {
  if (!hasPoses()) return Pose3::Identity();
  return poses_[static_cast<std::size_t>(frame)] * T_ego_pose_.inverse() * T_ego_velo_;
}

/// DIR/000012.EXT as in the tracking benchmark or DIR/0000000012.EXT as in the raw data; empty when
/// there is none.
std::string fileOfFrame(const std::string& dir, std::int64_t frame,
                        const std::vector<std::string>& endings) {
  const std::string path = fileOfStem(dir, fmt::format("{:06}", frame), endings);
  return path.empty() ? fileOfStem(dir, fmt::format("{:010}", frame), endings) : path;
}

std::optional<LidarCloud> Import::readScan(std::int64_t frame) {
  if (params_.lidar_dir.empty()) return {};
  const std::string path = fileOfFrame(params_.lidar_dir, frame, kScanEndings);
  if (path.empty()) {
    log_.missing("scan", params_.lidar_dir, frame);
    return {};
  }
  return readKittiScan(path);
}

void Import::writeFrame(std::int64_t frame) {
  const Stamp stamp = stampOf(frame);
  if (hasPoses()) log_.ego(stamp, egoAt(frame));
  log_.frame(stamp, frame);
  const std::optional<LidarCloud> cloud = readScan(frame);
  if (cloud) log_.sensor(kLidarTop, stamp, T_ego_velo_, *cloud);
  detections_.write(frame, stamp, calibration_, T_ego_velo_, posesVelodyneAt(frame), log_);
  if (!params_.images_dir.empty()) writeImage(frame);
  if (!params_.labels.empty()) addTruth(frame, cloud);
}

void Import::writeImage(std::int64_t frame) {
  const std::string path = fileOfFrame(params_.images_dir, frame, kImageEndings);
  if (path.empty()) return log_.missing("image", params_.images_dir, frame);
  const Pose3 T_ego_camera =
      T_ego_velo_ * calibration_.T_cam0_velo.inverse() * calibration_.T_cam0_cam2;
  log_.image({kCameraLeft, path, stampOf(frame), calibration_.camera, T_ego_camera}, frame);
}

void Import::addTruth(std::int64_t frame, const std::optional<LidarCloud>& cloud) {
  const auto here = labels_.find(frame);
  if (here == labels_.end()) return;
  const Pose3 T_world_velo = egoAt(frame) * T_ego_velo_;
  for (const KittiLabel& label : here->second) {
    log_.truth(stampOf(frame), truthOf(label, calibration_, T_world_velo, cloud));
  }
}

void Import::run() {
  checkParams();
  readAll();
  if (!params_.labels.empty()) log_.expectTruth();
  for (std::int64_t frame = options_.first; frame <= last_; ++frame) {
    writeFrame(frame);
    log_.progress(frame - options_.first + 1, last_ - options_.first + 1);
  }
}

/// The sub-command kitti.
class KittiImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override;
  void prepare(ImportOptions& options) override;
  void run(ImportLog& log) override { Import(params_, log).run(); }

 private:
  KittiImportParams params_;
};

void KittiImporter::declare(CLI::App& cli) {
  auto& p = params_;
  cli.add_option("--calib", p.calibration, "calibration file (P2, R0_rect, Tr_velo_to_cam)")
      ->required();
  auto* poses = cli.add_option("--poses", p.poses,
                               "ego poses, one line a frame; without and without --oxts: none");
  cli.add_option("--poses-frame", p.poses_frame, "whose poses they are")
      ->check(CLI::IsMember({"velodyne", "camera", "imu"}))
      ->capture_default_str();
  cli.add_option("--poses-format", p.poses_format,
                 "kitti: 12 numbers (3x4); tum: t x y z qx qy qz qw")
      ->check(CLI::IsMember({"kitti", "tum"}))
      ->capture_default_str();
  cli.add_option("--oxts", p.oxts, "GPS/IMU file, instead of --poses")->excludes(poses);
  cli.add_option("--lidar", p.lidar_dir, "folder of Velodyne scans, FRAME.bin or FRAME.bin.gz");
  cli.add_option("--labels", p.labels, "truth: tracking labels");
  cli.add_option("--images", p.images_dir,
                 "folder of left color images, FRAME.png or FRAME.jpg; copied beside the log "
                 "unless --embed-images");
  cli.add_option(
      "--detections", p.detections,
      "NAME:CLASS=FILE, repeatable; NAME: boxes3d (AB3DMOT's or KITTI's columns, nuScenes' JSON), "
      "pointrcnn, "
      "pointgnn, rrc, dpm, kitti3d, kitti2d (or one of them and -anything); CLASS: rows of this "
      "type, or all");
}

void KittiImporter::prepare(ImportOptions& options) {
  if (options.images == ImportOptions::Images::kReference)
    options.images = ImportOptions::Images::kCopy;
}

}  // namespace

std::unique_ptr<Importer> makeKittiImporter() { return std::make_unique<KittiImporter>(); }

}  // namespace perception
