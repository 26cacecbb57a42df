#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/PoseSteps.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/positions/ImportClock.h"
#include "libperception/importers/weather_sets/ImportRadarPicture.h"
#include "libperception/importers/weather_sets/RadiateFiles.h"
#include "libperception/sensors/images/ImageFile.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kCsvEndings = {".csv", ".csv.gz"};
/// [s] Radar frames up to this much older than the first fix are extrapolated with its velocity.
constexpr double kBeforeFirstPose = 1;
/// [s] of lidar scans for the estimation of the GPS clock offset.
constexpr double kShiftScans = 4;
/// [s] Search range of the offset about the one at which both recordings begin together.
constexpr double kShiftReach = 5;

/// Options: parts of the folder to read, and parameters that the recording lacks.
struct RadiateParams {
  std::string dir;
  double lidar_height = 2.05;  ///< [m] road returns lie so far below the lidar (frame 28)
  /// [s] Delay of the radar's stamps: at 10 m/s its images match the lidar's returns moved 2.0 m
  /// ahead (correlation over radar frames 3, 8, 13, 17). One revolution takes 0.25 s.
  double radar_delay = 0.2;
  /// [s] added to GPS stamps, whose clock is not synchronized; empty: by clockShift().
  std::optional<double> gps_shift;
  RadarPictureParams radar;
  bool radar_images = false;  ///< also as images
};

/// RADIATE: a sequence's folder.
class RadiateImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override;
  void run(ImportLog& log) override;

 private:
  fs::path path(const char* name) const { return fs::path(params_.dir) / name; }
  void addRadar(ImportLog& log);
  void addLidar(ImportLog& log);
  void addImages(ImportLog& log);
  double gpsShift(const std::vector<GpsFix>& fixes, ImportLog& log) const;
  void addGps(ImportLog& log);
  void addTruth(ImportLog& log);
  std::optional<Pose3> egoAt(Stamp stamp) const;
  bool inside(Stamp stamp) const { return !first_ || (*first_ <= stamp && stamp <= last_); }
  Stamp radarStamp(Stamp stamp) const { return stamp + -params_.radar_delay; }

  RadiateParams params_;
  RadiateCalibration calibration_;
  Pose3 T_ego_lidar_ = Pose3::Identity();
  double radar_height_ = 0;  ///< [m] above the road; the ego origin is below the radar
  FrameTimes radar_times_;
  std::vector<StampedPose> poses_;
  std::optional<Stamp> first_;  ///< of the part that is wanted
  Stamp last_;
};

void RadiateImporter::declare(CLI::App& cli) {
  cli.add_option("--dir", params_.dir,
                 "a sequence: Navtech_Cartesian/, velo_lidar/, zed_left/, their .txt, calib.yaml, "
                 "annotations")
      ->required();
  cli.add_option("--lidar-height", params_.lidar_height, "[m] of the lidar above the road")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  cli.add_option("--radar-delay", params_.radar_delay, "[s] by which the radar's stamps are late")
      ->check(CLI::Range(-5.0, 5.0))
      ->capture_default_str();
  cli.add_option("--gps-shift", params_.gps_shift,
                 "[s] added to the GPS stamps; default: what makes the lidar's scans agree");
  declareRadarPicture(cli, params_.radar);
  cli.add_flag("--radar-images", params_.radar_images, "the radar's pictures as images, too");
}

std::optional<Pose3> RadiateImporter::egoAt(Stamp stamp) const {
  if (poses_.size() < 2) return {};
  if (stamp < poses_.front().stamp && poses_.front().stamp - stamp <= kBeforeFirstPose) {
    const double share = (stamp - poses_[0].stamp) / (poses_[1].stamp - poses_[0].stamp);
    return interpolate(poses_[0].pose, poses_[1].pose, share);
  }
  return poseBetween(poses_, stamp);
}

void RadiateImporter::addRadar(ImportLog& log) {
  for (const auto& [file, time] :
       timedFiles(path("Navtech_Cartesian"), {".png"}, radar_times_, true, log)) {
    const Stamp stamp = radarStamp(time);
    if (!first_) first_ = stamp;
    last_ = stamp;
    log.at(stamp, [this, stamp, file = file, &log] {
      log.frame(stamp, file.number);
      log.sensor(kRadarTop, stamp, makePose(0, 0, radar_height_, 0),
                 radarReturnsOf(file.path, params_.radar));
      if (params_.radar_images)
        log.image({"RADAR_PICTURE", file.path, stamp, {}, Pose3::Identity()}, file.number);
    });
  }
  if (!first_)
    throw DataError(path("Navtech_Cartesian").string() + ": none of the wanted frames",
                    ExitCode::kNoInput);
  first_ = *first_ + -0.5;
  last_ = last_ + 0.5;
}

void RadiateImporter::addLidar(ImportLog& log) {
  const FrameTimes times = readRadiateTimes(path("velo_lidar.txt"));
  for (const auto& [file, stamp] : timedFiles(path("velo_lidar"), kCsvEndings, times, false, log)) {
    if (!inside(stamp)) continue;
    log.at(stamp, [this, stamp = stamp, file = file, &log] {
      log.sensor(kLidarTop, stamp, T_ego_lidar_, readRadiateScan(file.path));
    });
  }
}

void RadiateImporter::addImages(ImportLog& log) {
  if (!fs::exists(path("zed_left"))) return;
  const FrameTimes times = readRadiateTimes(path("zed_left.txt"));
  // Optical axes: x right, y down, z ahead; the calibration's rotation of a degree is ignored,
  // since its convention is not documented.
  Pose3 T_ego_camera = makePose(calibration_.camera.y(), -calibration_.camera.x(),
                                radar_height_ + calibration_.camera.z(), 0);
  T_ego_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (const auto& [file, stamp] :
       timedFiles(path("zed_left"), {".png", ".jpg"}, times, false, log)) {
    if (!inside(stamp)) continue;
    const ImportedImage image{kCameraLeft,        file.path,    stamp,
                              calibration_.model, T_ego_camera, calibration_.distortion};
    log.at(image.stamp, [image, number = file.number, &log] { log.image(image, number); });
  }
}

/// Offset of the GPS clock, by clockShift() of scans in the middle of the imported part.
double RadiateImporter::gpsShift(const std::vector<GpsFix>& fixes, ImportLog& log) const {
  const FrameTimes times = readRadiateTimes(path("velo_lidar.txt"));
  const double at_once = times.begin()->second - fixes.front().stamp;
  const Stamp middle = *first_ + (last_ - *first_) / 2;
  std::vector<StampedScan> scans;
  for (const FrameFile& file : frameFiles(path("velo_lidar").string(), kCsvEndings)) {
    const auto time = times.find(file.number);
    if (time == times.end() || std::abs(time->second - middle) > kShiftScans / 2) continue;
    const LidarCloud cloud = readRadiateScan(file.path);
    auto& scan = scans.emplace_back(time->second, std::vector<Vector3>());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      scan.second.push_back(T_ego_lidar_ * Vector3(cloud.x[i], cloud.y[i], cloud.z[i]));
  }
  const auto found = clockShift(posesOfFixes(fixes), scans, at_once, kShiftReach);
  if (!found)
    log.warn(path("gps.csv").string() +
             ": its clock is not synchronized and the scans do not tell its shift: taken to begin "
             "with the lidar's (--gps-shift)");
  return found.value_or(at_once);
}

void RadiateImporter::addGps(ImportLog& log) {
  if (!fs::exists(path("gps.csv"))) return;
  std::size_t dropped = 0;
  std::vector<GpsFix> fixes = readRadiateFixes(params_.dir, dropped);
  if (dropped > 0)
    log.warn(fmt::format("{}: {} fixes left out while their clock was set back",
                         path("gps.csv").string(), dropped));
  const double shift = params_.gps_shift ? *params_.gps_shift : gpsShift(fixes, log);
  for (GpsFix& fix : fixes) fix.stamp = fix.stamp + shift;
  poses_ = posesOfFixes(fixes);
  for (std::size_t i = 0; i < fixes.size(); ++i) {
    const Stamp stamp = fixes[i].stamp;
    if (!inside(stamp)) continue;
    log.at(stamp, [this, stamp, i, fix = fixes[i], &log] {
      log.ego(stamp, poses_[i].pose);
      log.observation(*gpsObservation(fix));
    });
  }
  // Radar frames from before the first fix.
  if (first_ && *first_ < fixes.front().stamp) {
    for (const auto& [frame, time] : radar_times_) {
      const Stamp stamp = radarStamp(time);
      if (!log.wants(frame) || stamp >= fixes.front().stamp) continue;
      const auto pose = egoAt(stamp);
      if (pose) log.at(stamp, [stamp, pose = *pose, &log] { log.ego(stamp, pose); });
    }
  }
  log.note(fmt::format("GPS stamps moved by {:.3f} s; heading by the course over ground", shift));
}

void RadiateImporter::addTruth(ImportLog& log) {
  const std::string file = radiateAnnotationFile(params_.dir);
  if (file.empty()) return;
  log.expectTruth();
  const cv::Mat picture = readImageFile(
      frameFiles(path("Navtech_Cartesian").string(), {".png"}).front().path, cv::IMREAD_GRAYSCALE);
  const double center_u = picture.cols * 0.5, center_v = picture.rows * 0.5;
  for (const auto& [frame, boxes] : readRadiateAnnotations(file)) {
    const auto time = radar_times_.find(frame);
    if (time == radar_times_.end() || !log.wants(frame)) continue;
    const Stamp stamp = radarStamp(time->second);
    const auto ego = egoAt(stamp);
    for (const RadiateAnnotation& a : boxes) {
      ObjectDetection::SpaceBox box;
      const double u = a.x + a.width / 2, v = a.y + a.length / 2;
      box.bottom_center =
          Vector3((center_v - v) * params_.radar.pixel, (center_u - u) * params_.radar.pixel, 0);
      // An upright box points ahead; the turn is counter-clockwise in the picture, as ours.
      box.yaw = wrapAngle(radians(a.rotation));
      box.length = a.length * params_.radar.pixel;
      box.width = a.width * params_.radar.pixel;
      TruthObject o;
      placeTruth(box, ego.value_or(Pose3::Identity()), o);
      o.height = std::numeric_limits<double>::quiet_NaN();
      o.frame = frame;
      o.id = a.id;
      o.type = a.type;
      o.ignore = !coveredType(a.type);
      log.truth(stamp, std::move(o));
    }
  }
}

void RadiateImporter::run(ImportLog& log) {
  requireFolder(params_.dir);
  calibration_ = readRadiateCalibration(path("calib.yaml").string());
  radar_height_ = params_.lidar_height - calibration_.lidar.z();
  // The file's x looks to the right, its y ahead.
  T_ego_lidar_ =
      makePose(calibration_.lidar.y(), -calibration_.lidar.x(), params_.lidar_height, -kPi / 2);
  radar_times_ = readRadiateTimes(path("Navtech_Cartesian.txt"));
  addRadar(log);
  addGps(log);  // before the others: poses first at an instant
  addLidar(log);
  addImages(log);
  addTruth(log);
  log.writeInOrder();
}

}  // namespace

std::unique_ptr<Importer> makeRadiateImporter() { return std::make_unique<RadiateImporter>(); }

}  // namespace perception
