#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/positions/ImportClock.h"
#include "libperception/importers/truth/LabeledBoxes.h"
#include "libperception/importers/truth/VehicleAxes.h"
#include "libperception/importers/weather_sets/BoreasFiles.h"
#include "libperception/importers/weather_sets/ImportRadarPicture.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// A drive of Boreas: lidar, turning radar, camera, poses of each; boxes where it has them.
class BoreasImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override;
  void run(ImportLog& log) override;

 private:
  std::string in(const char* name) const { return (fs::path(dir_) / name).string(); }
  LidarCloud scan(const std::string& path) const { return readCloudFile(path, format_); }
  void readPlace(const std::vector<FrameFile>& scans, ImportLog& log);
  void readMotion();
  void addScans(const std::vector<FrameFile>& scans, ImportLog& log);
  void addRadar(ImportLog& log);
  void addImages(ImportLog& log);
  bool inside(Stamp stamp) const { return first_ <= stamp && stamp <= last_; }

  std::string dir_;
  std::optional<double> height_;
  CloudFormat format_;
  RadarPictureParams radar_;
  std::vector<StampedPose> lidar_poses_, poses_;  ///< of the lidar in ENU; of the ego frame
  Pose3 T_ego_lidar_ = Pose3::Identity();
  Stamp first_, last_;  ///< of the wanted scans
};

void BoreasImporter::declare(CLI::App& cli) {
  radar_.pixel = 0.0596, radar_.range = 200, radar_.around_cells = 8;
  cli.add_option("--dir", dir_,
                 "a drive: lidar/, applanix/lidar_poses.csv, calib/, and where there are radar/, "
                 "camera/, labels_tracking/")
      ->required();
  cli.add_option("--lidar-height", height_,
                 "[m] of the lidar above the road; default: found from its returns")
      ->check(CLI::Range(0.1, 10.0));
  cli.add_option("--radar-cell", radar_.pixel,
                 "[m] of the radar's pictures: 0.0596, in later drives 0.04381")
      ->check(CLI::Range(1e-3, 10.0))
      ->capture_default_str();
  declareRadarPicture(cli, radar_);
  format_.columns = {"x", "y", "z", "intensity", "ring", "time"};
  format_.about_stamp = true;
}

/// The lidar looks to anywhere: ahead is where it travels to.
void BoreasImporter::readPlace(const std::vector<FrameFile>& scans, ImportLog& log) {
  const auto read = [this](const std::string& path) { return scan(path); };
  format_.intensity_max = intensityScaleOf(scans, read);
  const bool given = height_.has_value();
  if (!given) height_ = heightAboveRoad(scans, read);
  if (!height_)
    throw DataError(in("lidar") +
                    ": its returns do not tell the height of the lidar; say it: --lidar-height");
  constexpr double kSteady = 0.9;
  const auto travel = travelDirection(lidar_poses_);
  if (travel && travel->norm() < kSteady)
    throw DataError(in("applanix/lidar_poses.csv") +
                    ": the lidar travels to no direction of its own; expected attitudes as in "
                    "Boreas' kit");
  if (!travel) log.warn("the vehicle stands: its lidar is taken to look ahead");
  const double ahead = travel ? std::atan2(travel->y(), travel->x()) : 0;
  T_ego_lidar_ = makePose(0, 0, *height_, -ahead);
  log.note(fmt::format("lidar {:.2f} m above the road{}, turned by {:.1f} deg against the way",
                       *height_, given ? "" : " by its returns (--lidar-height)", degrees(ahead)));
}

/// World: below the lidar at its first pose.
void BoreasImporter::readMotion() {
  const Pose3 first = lidar_poses_.front().pose * T_ego_lidar_.inverse();
  const Vector3 at = first.translation();
  const Pose3 T_world_enu = makePose(at.x(), at.y(), at.z(), yawOf(first)).inverse();
  for (const StampedPose& pose : lidar_poses_)
    poses_.push_back({pose.stamp, T_world_enu * pose.pose * T_ego_lidar_.inverse()});
}

void BoreasImporter::addScans(const std::vector<FrameFile>& scans, ImportLog& log) {
  const std::string labels =
      fs::is_directory(in("labels_tracking")) ? in("labels_tracking") : in("labels_detection");
  const bool labeled = fs::is_directory(labels);
  if (labeled) log.expectTruth();
  if (!labeled) log.note("no labels_tracking/ or labels_detection/: no truth");
  auto truth = std::make_shared<BoxTruth>(log);
  for (const FrameFile& file : scans) {
    if (!log.wants(file.number)) continue;
    const Stamp stamp = stampOfBoreas(file);
    if (last_.ns == 0) first_ = stamp;
    last_ = stamp;
    log.at(stamp, [=, &log] {
      log.frame(stamp, file.number);
      LidarCloud cloud = scan(file.path);
      const auto pose = poseBetween(poses_, stamp);
      const std::string boxes = fileOfStem(labels, file.stem, {".txt"});
      if (labeled && !boxes.empty() && pose)
        truth->add(readBoreasBoxes(boxes), file.number, stamp, *pose * T_ego_lidar_, cloud);
      log.sensor(kLidarTop, stamp, T_ego_lidar_, std::move(cloud));
    });
  }
}

void BoreasImporter::addRadar(ImportLog& log) {
  if (!fs::is_directory(in("radar"))) return;
  const Pose3 T_ego_radar =
      T_ego_lidar_ * readBoreasTransform(in("calib/T_radar_lidar.txt")).inverse();
  for (const FrameFile& file : frameFiles(in("radar"), {".png"})) {
    const Stamp stamp = stampOfBoreas(file);
    if (!inside(stamp)) continue;
    log.at(stamp, [=, &log] {
      const BoreasRadar picture = readBoreasRadar(file.path);
      log.sensor(kRadarTop, stamp, T_ego_radar,
                 radarReturnsOf(picture.power, picture.azimuths, kBoreasRangeOffset, radar_));
    });
  }
}

void BoreasImporter::addImages(ImportLog& log) {
  if (!fs::is_directory(in("camera"))) return;
  ImportedImage image;
  image.label = kCameraFront;
  image.T_ego_camera = T_ego_lidar_ * readBoreasTransform(in("calib/T_camera_lidar.txt")).inverse();
  image.camera = readBoreasCamera(in("calib/P_camera.txt"));
  for (const FrameFile& file : frameFiles(in("camera"), {".png", ".jpg"})) {
    image.stamp = stampOfBoreas(file);
    image.path = file.path;
    if (!inside(image.stamp)) continue;
    log.at(image.stamp, [&log, image, number = file.number] { log.image(image, number); });
  }
}

void BoreasImporter::run(ImportLog& log) {
  requireFolder(dir_);
  const std::vector<FrameFile> scans = frameFiles(in("lidar"), {".bin", ".bin.gz"});
  lidar_poses_ = readBoreasPoses(in("applanix/lidar_poses.csv"));
  readPlace(scans, log);
  readMotion();
  for (const StampedPose& pose : poses_)
    log.at(pose.stamp, [&log, pose] { log.ego(pose.stamp, pose.pose); });
  addScans(scans, log);
  addRadar(log);
  addImages(log);
  log.writeInOrder();
}

}  // namespace

std::unique_ptr<Importer> makeBoreasImporter() { return std::make_unique<BoreasImporter>(); }

}  // namespace perception
