#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/kitti/KittiRawFiles.h"
#include "libperception/importers/positions/ImportClock.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// A drive of KITTI's raw data: each sensor with its own stamps.
class KittiRawImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_,
                   "a drive: velodyne_points/, oxts/, and where there are image_02/ and "
                   "tracklet_labels.xml")
        ->required();
    cli.add_option("--calib", calib_,
                   "folder of calib_velo_to_cam.txt, calib_cam_to_cam.txt, calib_imu_to_velo.txt; "
                   "default: the one above the drive");
  }
  void run(ImportLog& log) override;

 private:
  std::string in(const std::string& name) const { return (fs::path(dir_) / name).string(); }
  void readMotion();
  void addMotion(ImportLog& log);
  void addScans(ImportLog& log);
  void addImages(ImportLog& log);
  void addTracklets(std::int64_t frame, Stamp stamp, const LidarCloud& cloud, ImportLog& log);

  std::string dir_, calib_;
  KittiCalibration calibration_;
  Pose3 T_ego_velo_ = makePose(0, 0, kKittiVelodyneHeight, 0);
  std::vector<StampedPose> poses_;  ///< of the ego frame
  std::multimap<std::int64_t, KittiTracklet> tracklets_;
};

/// World: the ego frame at the first pose.
void KittiRawImporter::readMotion() {
  const KittiRawSeries oxts = readKittiRawSeries(in("oxts"), {".txt"});
  std::vector<std::string> paths;
  for (const FrameFile& file : oxts.files) paths.push_back(file.path);
  const std::vector<Pose3> imu = readKittiOxts(paths);
  const Pose3 T_ego_imu = T_ego_velo_ * *calibration_.T_velo_imu;
  for (std::size_t i = 0; i < oxts.files.size(); ++i)
    poses_.push_back(
        {oxts.stamps[i], T_ego_imu * imu.front().inverse() * imu[i] * T_ego_imu.inverse()});
}

void KittiRawImporter::addMotion(ImportLog& log) {
  for (const StampedPose& pose : poses_)
    log.at(pose.stamp, [&log, pose] { log.ego(pose.stamp, pose.pose); });
}

void KittiRawImporter::addTracklets(std::int64_t frame, Stamp stamp, const LidarCloud& cloud,
                                    ImportLog& log) {
  const auto pose = poseBetween(poses_, stamp);
  const auto [from, to] = tracklets_.equal_range(frame);
  for (auto row = from; row != to && pose; ++row) {
    const KittiTracklet& tracklet = row->second;
    TruthObject object;
    object.frame = frame;
    object.id = tracklet.id;
    object.type = tracklet.type;
    object.occluded = tracklet.occluded;
    object.truncated = tracklet.outside ? 1 : tracklet.cut ? 0.5 : 0;
    object.ignore = !coveredType(tracklet.type);
    placeTruth(tracklet.box, *pose * T_ego_velo_, object);
    object.lidar_points = returnsInside(tracklet.box, cloud);
    log.truth(stamp, std::move(object));
  }
}

void KittiRawImporter::addScans(ImportLog& log) {
  const KittiRawSeries scans = readKittiRawSeries(in("velodyne_points"), {".bin", ".bin.gz"});
  for (std::size_t i = 0; i < scans.files.size(); ++i) {
    const FrameFile file = scans.files[i];
    if (!log.wants(file.number)) continue;
    log.at(scans.stamps[i], [this, &log, file, stamp = scans.stamps[i]] {
      log.frame(stamp, file.number);
      LidarCloud cloud = readKittiScan(file.path);
      addTracklets(file.number, stamp, cloud, log);
      log.sensor(kLidarTop, stamp, T_ego_velo_, std::move(cloud));
    });
  }
}

void KittiRawImporter::addImages(ImportLog& log) {
  if (!fs::is_directory(in("image_02/data"))) return;
  const KittiRawSeries images = readKittiRawSeries(in("image_02"), {".png", ".jpg"});
  for (std::size_t i = 0; i < images.files.size(); ++i) {
    const FrameFile file = images.files[i];
    if (!log.options().wants(file.number)) continue;
    const ImportedImage image{
        kCameraLeft, file.path, images.stamps[i], calibration_.camera,
        T_ego_velo_ * calibration_.T_cam0_velo.inverse() * calibration_.T_cam0_cam2};
    log.at(image.stamp, [&log, image, number = file.number] { log.image(image, number); });
  }
}

void KittiRawImporter::run(ImportLog& log) {
  requireFolder(dir_);
  const fs::path drive = fs::absolute(dir_).lexically_normal();
  const fs::path above = (drive.has_filename() ? drive : drive.parent_path()).parent_path();
  calibration_ = readKittiRawCalibration(calib_.empty() ? above.string() : calib_);
  readMotion();
  const std::string labels = in("tracklet_labels.xml");
  if (fs::exists(labels)) {
    tracklets_ = readKittiTracklets(labels);
    log.expectTruth();
  } else {
    log.note("no tracklet_labels.xml: no truth");
  }
  addMotion(log);
  addScans(log);
  addImages(log);
  log.writeInOrder();
}

}  // namespace

std::unique_ptr<Importer> makeKittiRawImporter() { return std::make_unique<KittiRawImporter>(); }

}  // namespace perception
