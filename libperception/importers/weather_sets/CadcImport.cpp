#include <fmt/format.h>
#include <mrpt/containers/yaml.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/kitti/KittiRawFiles.h"
#include "libperception/importers/positions/ImportClock.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/importers/truth/LabeledBoxes.h"
#include "libperception/importers/truth/VehicleAxes.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

constexpr double kVlp32cRange = 200;  // [m] data sheet

/// A sequence of the Canadian Adverse Driving Conditions data set: scans, GPS/IMU, boxes.
class CadcImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_,
                   "labeled/, processed/ or raw/ of a sequence: lidar_points/, novatel/; above it "
                   "3d_ann.json and the drive's calib/")
        ->required();
    cli.add_option("--lidar-height", height_,
                   "[m] of the lidar above the road; default: found from its returns")
        ->check(CLI::Range(0.1, 10.0));
  }
  void run(ImportLog& log) override;

 private:
  std::string in(const char* name) const { return (fs::path(dir_) / name).string(); }
  LidarCloud scan(const std::string& path) const { return readCloudFile(path, format_); }
  void readPlace(const KittiRawSeries& scans, ImportLog& log);
  Vector3 leverArm(const fs::path& drive, ImportLog& log) const;
  void readMotion(const fs::path& drive, ImportLog& log);
  void addScans(const KittiRawSeries& scans, ImportLog& log);

  std::string dir_;
  std::optional<double> height_;
  CloudFormat format_;
  Pose3 T_ego_lidar_ = Pose3::Identity();
  std::vector<StampedPose> poses_;  ///< of the ego frame
  std::vector<std::vector<DataSetBox>> boxes_;
};

void CadcImporter::readPlace(const KittiRawSeries& scans, ImportLog& log) {
  const auto read = [this](const std::string& path) { return scan(path); };
  format_.max_range = kVlp32cRange;
  format_.intensity_max = intensityScaleOf(scans.files, read);
  const bool given = height_.has_value();
  if (!given) height_ = heightAboveRoad(scans.files, read);
  if (!height_)
    throw DataError(in("lidar_points") +
                    ": its returns do not tell the height of the lidar; say it: --lidar-height");
  if (!given)
    log.note(
        fmt::format("lidar height {:.2f} m, found from its returns (--lidar-height)", *height_));
  T_ego_lidar_ = makePose(0, 0, *height_, 0);
}

/// The GPS/IMU's place in the lidar's frame.
Vector3 CadcImporter::leverArm(const fs::path& drive, ImportLog& log) const {
  const std::string path = (drive / "calib" / "extrinsics.yaml").string();
  if (!fs::exists(path)) {
    log.warn(path + ": not there: the GPS/IMU is taken to be at the lidar");
    return Vector3::Zero();
  }
  try {
    const auto yaml = mrpt::containers::yaml::FromFile(path);
    const auto rows = yaml["T_LIDAR_GPSIMU"];
    Vector3 place;
    for (int i = 0; i < 3; ++i) place[i] = rows(i)(3).as<double>();
    return place;
  } catch (const std::exception& e) {
    const std::string what = e.what();
    throw DataError(fmt::format("{}: expected T_LIDAR_GPSIMU with four rows of four numbers: {}",
                                path, what.substr(0, what.find('\n'))));
  }
}

/// Attitudes by their definition: the azimuth is clockwise from north, the pitch positive where the
/// nose rises, the roll where the right side sinks. World: below the lidar at the first pose.
void CadcImporter::readMotion(const fs::path& drive, ImportLog& log) {
  constexpr std::size_t kRoll = 7, kPitch = 8, kAzimuth = 9;
  const KittiRawSeries novatel = readKittiRawSeries(in("novatel"), {".txt"});
  const Vector3 lever = T_ego_lidar_ * leverArm(drive, log);
  std::vector<GpsFix> fixes;
  std::vector<Pose3> attitudes;
  for (std::size_t i = 0; i < novatel.files.size(); ++i) {
    forEachRow(novatel.files[i].path, kCommas, [&](const TextRow& row) {
      row.expect(row.size() > kAzimuth, "10 or more: latitude, longitude, altitude ... azimuth");
      if (fixes.size() > i) row.failLine("more than one line");
      fixes.push_back({novatel.stamps[i], row.real(0), row.real(1), row.real(2)});
      attitudes.push_back(makePose(0, 0, 0, kPi / 2 - radians(row.real(kAzimuth)),
                                   -radians(row.real(kPitch)), radians(row.real(kRoll))));
    });
    if (fixes.size() <= i) throw DataError(novatel.files[i].path + ": empty");
  }
  const std::vector<Vector2> places = localPositions(fixes);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    Pose3 pose = attitudes[i];
    pose.translation() =
        Vector3(places[i].x(), places[i].y(), fixes[i].altitude) - attitudes[i].linear() * lever;
    poses_.push_back({fixes[i].stamp, pose});
  }
  const Pose3 first = poses_.front().pose;
  const Vector3 at = first.translation();
  const Pose3 T_world_enu = makePose(at.x(), at.y(), at.z(), yawOf(first)).inverse();
  for (StampedPose& pose : poses_) pose.pose = T_world_enu * pose.pose;
  constexpr double kAhead = 0.9;  // within 26 deg
  const auto travel = travelDirection(poses_);
  if (travel && travel->x() < kAhead)
    log.warn(in("novatel") + ": the vehicle does not travel to where its azimuth points");
}

void CadcImporter::addScans(const KittiRawSeries& scans, ImportLog& log) {
  BoxTruth truth(log);
  for (std::size_t i = 0; i < scans.files.size(); ++i) {
    const FrameFile& file = scans.files[i];
    if (!log.wants(file.number)) continue;
    log.at(scans.stamps[i], [this, &log, &truth, file, stamp = scans.stamps[i]] {
      log.frame(stamp, file.number);
      LidarCloud cloud = scan(file.path);
      const auto pose = poseBetween(poses_, stamp);
      const auto k = static_cast<std::size_t>(file.number);
      if (k < boxes_.size() && pose)
        truth.add(boxes_[k], file.number, stamp, *pose * T_ego_lidar_, cloud);
      log.sensor(kLidarTop, stamp, T_ego_lidar_, std::move(cloud));
    });
  }
  log.writeInOrder();
}

void CadcImporter::run(ImportLog& log) {
  requireFolder(dir_);
  fs::path folder = fs::absolute(dir_).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  const fs::path sequence = folder.parent_path();
  const KittiRawSeries scans = readKittiRawSeries(in("lidar_points"), {".bin", ".bin.gz"});
  readPlace(scans, log);
  readMotion(sequence.parent_path(), log);
  const std::string labels = (sequence / "3d_ann.json").string();
  // Frames are numbered as in labeled/; the other folders have more scans.
  const bool labeled = fs::exists(labels) && folder.filename() == "labeled";
  if (labeled) {
    boxes_ = readCadcBoxes(labels);
    log.expectTruth();
  } else {
    log.note("no truth: 3d_ann.json is of the scans of labeled/");
  }
  for (const StampedPose& pose : poses_)
    log.at(pose.stamp, [&log, pose] { log.ego(pose.stamp, pose.pose); });
  addScans(scans, log);
  log.note("images are not taken: the layout of their calibration was not at hand");
}

}  // namespace

std::unique_ptr<Importer> makeCadcImporter() { return std::make_unique<CadcImporter>(); }

}  // namespace perception
