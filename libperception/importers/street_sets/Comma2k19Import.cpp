#include <fmt/format.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Median.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/positions/ImportGps.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

/// [m] Height of the device behind the windshield above the road, openpilot's model_height.
constexpr double kDeviceHeight = 1.22;
/// [m] The radar ahead of the device, openpilot's RADAR_TO_CAMERA.
constexpr double kRadarAhead = 1.52;
constexpr double kRadarHeight = 0.5;  ///< [m] behind the grille; irrelevant on flat ground
/// [deg] The device looks left of the car's course and down: medians over the example minute above
/// 5 m/s (quartiles 0.74 and 0.89 deg, -3.93 and -3.63 deg).
constexpr double kDeviceYawDeg = 0.81, kDeviceUpDeg = -3.81;
constexpr int kFirstSlot = 528;  ///< CAN address of the radar's first track slot
/// [s] Largest time between rows of one scan: slots are sent one after the other.
constexpr double kScanSpread = 0.025;
/// [s] Latency of the unit's filter: minimizes the spread of the range rates of stationary objects
/// (tests/radar/RealReturns_test).
constexpr double kRadarDelay = 0.05;
constexpr double kRadarRange = 200;  ///< [m] of the unit; the example reaches 184 m

/// The columns of one of the recording's tables.
struct Table {
  explicit Table(const fs::path& path)
      : csv(CsvTable::fromFile(path.string())), t(csv.column("t_s")) {}
  double at(std::size_t row, const char* column) const { return csv.real(row, csv.column(column)); }
  double time(std::size_t row) const { return csv.real(row, t); }
  CsvTable csv;
  CsvTable::Column t;
};

/// WGS 84 position of an ECEF point ([bowring1976]; below a millimeter at the ground).
GpsFix geodetic(const Vector3& p) {
  constexpr double a = 6378137.0, f = 1 / 298.257223563;
  constexpr double b = a * (1 - f), e2 = f * (2 - f), ep2 = e2 / (1 - e2);
  const double flat = p.head<2>().norm(), u = std::atan2(p.z() * a, flat * b);
  const double latitude = std::atan2(p.z() + ep2 * b * std::pow(std::sin(u), 3),
                                     flat - e2 * a * std::pow(std::cos(u), 3));
  const double s = std::sin(latitude);
  GpsFix fix;
  fix.latitude = degrees(latitude);
  fix.longitude = degrees(std::atan2(p.y(), p.x()));
  fix.altitude = flat / std::cos(latitude) - a / std::sqrt(1 - e2 * s * s);
  return fix;
}

/// East, north, up at a place on the ellipsoid.
Pose3 enuAt(const Vector3& ecef) {
  const GpsFix fix = geodetic(ecef);
  const double lat = radians(fix.latitude), lon = radians(fix.longitude);
  Pose3 T_ecef_enu = Pose3::Identity();
  T_ecef_enu.linear() << -std::sin(lon), -std::sin(lat) * std::cos(lon),
      std::cos(lat) * std::cos(lon), std::cos(lon), -std::sin(lat) * std::sin(lon),
      std::cos(lat) * std::sin(lon), 0, std::cos(lat), std::sin(lat);
  T_ecef_enu.translation() = ecef;
  return T_ecef_enu;
}

/// A minute of comma2k19: radar tracks, pose, speed, gyro, GNSS.
class Comma2k19Importer final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_, "folder with radar_tracks.csv, pose_20hz_ecef.csv ...")
        ->required();
    cli.add_option("--device-height", height_, "[m] of the device above the road")
        ->check(CLI::Range(0.1, 5.0))
        ->capture_default_str();
    cli.add_option("--device-yaw", yaw_, "[deg] the device looks left of the car's forward axis")
        ->check(CLI::Range(-20.0, 20.0))
        ->capture_default_str();
    cli.add_option("--device-up", up_, "[deg] it looks above it")
        ->check(CLI::Range(-20.0, 20.0))
        ->capture_default_str();
    cli.add_option("--radar-ahead", ahead_, "[m] of the radar ahead of the device")
        ->check(CLI::Range(-5.0, 10.0))
        ->capture_default_str();
    cli.add_option("--radar-delay", delay_, "[s] by which the radar's tracks are late")
        ->check(CLI::Range(-1.0, 1.0))
        ->capture_default_str();
  }
  void run(ImportLog& log) override;

 private:
  fs::path path(const char* name) const { return fs::path(dir_) / name; }
  Stamp stampOf(double t) const {
    return {kTickNs * std::llround((t + utc_offset_) * (1e9 / kTickNs))};
  }
  bool inside(double t) const { return t >= from_ - 1 && t <= to_ + 1; }
  void readGnss(ImportLog& log);
  void readRadar(ImportLog& log);
  void readPoses(ImportLog& log);
  void readMotion(ImportLog& log);

  std::string dir_;
  double height_ = kDeviceHeight, yaw_ = kDeviceYawDeg, up_ = kDeviceUpDeg, ahead_ = kRadarAhead;
  double delay_ = kRadarDelay;
  double utc_offset_ = 0;     ///< [s] UTC - device clock
  double from_ = 0, to_ = 0;  ///< [s] of the radar scans that are wanted
};

/// Offset of the device clock to UTC, by the receiver.
void Comma2k19Importer::readGnss(ImportLog& log) {
  const Table gnss(path("gnss_ublox_10hz.csv"));
  if (gnss.csv.rows() == 0)
    throw DataError(path("gnss_ublox_10hz.csv").string() + ": no fix in it");
  std::vector<double> offsets;
  for (std::size_t i = 0; i < gnss.csv.rows(); ++i)
    offsets.push_back(gnss.at(i, "utc_ms") * 1e-3 - gnss.time(i));
  utc_offset_ = medianOf(std::move(offsets));
  readRadar(log);  // determines the imported part
  for (std::size_t i = 0; i < gnss.csv.rows(); ++i) {
    if (!inside(gnss.time(i))) continue;
    const GpsFix fix{stampOf(gnss.time(i)), gnss.at(i, "lat_deg"), gnss.at(i, "lon_deg"),
                     gnss.at(i, "altitude_m")};
    log.at(fix.stamp, [fix, &log] { log.observation(*gpsObservation(fix)); });
  }
}

/// Range and bearing from forward and left; the unit's relative speed is along its forward axis.
RadarReturn returnOf(const Table& radar, std::size_t row) {
  const double forward = radar.at(row, "forward_m"), left = radar.at(row, "left_m");
  RadarReturn r;
  r.range = std::hypot(forward, left);
  r.bearing = std::atan2(left, forward);
  // It is not documented whether the unit gives the range rate or its forward component; within its
  // 10 degrees they differ by at most 1.5 %.
  r.range_rate = radar.at(row, "rel_speed_mps");
  r.id = static_cast<std::int32_t>(radar.csv.integer(row, radar.csv.column("can_address"))) -
         kFirstSlot;
  return r;
}

void Comma2k19Importer::readRadar(ImportLog& log) {
  const Table radar(path("radar_tracks.csv"));
  const Pose3 T_ego_radar = makePose(ahead_, 0, kRadarHeight, 0);
  std::int64_t number = 0;
  bool any = false;
  for (std::size_t i = 0; i < radar.csv.rows();) {
    RadarReturns returns;
    returns.max_range = kRadarRange;
    const double begin = radar.time(i);
    std::size_t end = i;
    for (; end < radar.csv.rows() && std::abs(radar.time(end) - begin) < kScanSpread; ++end)
      returns.returns.push_back(returnOf(radar, end));
    const std::int64_t frame = number++;
    const double t = radar.time(end - 1) - delay_;  // the scan is whole with its last slot
    i = end;
    if (!log.wants(frame)) continue;
    if (!any) from_ = t;
    any = true;
    to_ = t;
    log.at(stampOf(t), [=, &log, stamp = stampOf(t)] {
      log.frame(stamp, frame);
      log.sensor(kRadarFront, stamp, T_ego_radar, returns);
    });
  }
  if (!any) throw DataError(path("radar_tracks.csv").string() + ": none of the wanted scans");
}

void Comma2k19Importer::readPoses(ImportLog& log) {
  const Table poses(path("pose_20hz_ecef.csv"));
  if (poses.csv.rows() == 0)
    throw DataError(path("pose_20hz_ecef.csv").string() + ": no pose in it");
  // The device's axes are forward, right, down.
  Pose3 T_device_ego = Pose3::Identity();
  T_device_ego.linear() = Vector3(1, -1, -1).asDiagonal();
  const Pose3 T_ego_device = makePose(0, 0, height_, radians(yaw_), -radians(up_)) * T_device_ego;
  Pose3 T_enu_ecef = Pose3::Identity();
  for (std::size_t i = 0; i < poses.csv.rows(); ++i) {
    const auto T_ecef_device =
        poseFrom({poses.at(i, "x_m"), poses.at(i, "y_m"), poses.at(i, "z_m")},
                 {poses.at(i, "q0"), poses.at(i, "q1"), poses.at(i, "q2"), poses.at(i, "q3")});
    if (!T_ecef_device)
      throw DataError(fmt::format("{}:{}: q0 to q3: no unit quaternion", poses.csv.name(),
                                  poses.csv.lineOf(i)));
    if (i == 0) {  // world: east, north, up on the road under the first pose
      T_enu_ecef = enuAt(T_ecef_device->translation()).inverse();
      T_enu_ecef.pretranslate(Vector3(0, 0, height_));
    }
    if (!inside(poses.time(i))) continue;
    const Pose3 T_world_ego = T_enu_ecef * *T_ecef_device * T_ego_device.inverse();
    const Stamp stamp = stampOf(poses.time(i));
    log.at(stamp, [stamp, T_world_ego, &log] { log.ego(stamp, T_world_ego); });
  }
}

/// Gyro as it is; speed and gyro as wheel odometry, dead reckoned from the first row.
void Comma2k19Importer::readMotion(ImportLog& log) {
  const Table speed(path("ego_speed.csv")), gyro(path("gyro.csv"));
  for (std::size_t i = 0; i < gyro.csv.rows(); ++i) {
    if (!inside(gyro.time(i))) continue;
    auto imu = std::make_shared<mrpt::obs::CObservationIMU>();
    imu->timestamp = fromStamp(stampOf(gyro.time(i)));
    imu->sensorLabel = "IMU";
    imu->set(mrpt::obs::IMU_WX, gyro.at(i, "forward"));
    imu->set(mrpt::obs::IMU_WY, -gyro.at(i, "right"));
    imu->set(mrpt::obs::IMU_WZ, -gyro.at(i, "down"));
    log.at(stampOf(gyro.time(i)), [imu, &log] { log.observation(*imu); });
  }
  mrpt::poses::CPose2D place;
  std::size_t g = 0;
  for (std::size_t i = 0; i < speed.csv.rows(); ++i) {
    const double t = speed.time(i), v = speed.at(i, "speed_mps");
    while (g + 1 < gyro.csv.rows() && gyro.time(g + 1) <= t) ++g;
    const double turn = gyro.csv.rows() == 0 ? 0 : -gyro.at(g, "down");
    if (i > 0) {
      const double dt = t - speed.time(i - 1);
      place = place + mrpt::poses::CPose2D(v * dt, 0, turn * dt);
    }
    if (!inside(t)) continue;
    auto odometry = std::make_shared<mrpt::obs::CObservationOdometry>();
    odometry->timestamp = fromStamp(stampOf(t));
    odometry->sensorLabel = "ODOMETRY";
    odometry->odometry = place;
    odometry->hasVelocities = true;
    odometry->velocityLocal = {v, 0, turn};
    log.at(stampOf(t), [odometry, &log] { log.observation(*odometry); });
  }
}

void Comma2k19Importer::run(ImportLog& log) {
  requireFolder(dir_);
  readGnss(log);
  readPoses(log);
  readMotion(log);
  log.writeInOrder();
  log.note("no truth in this recording; the radar's tracks stand as returns, id = slot");
}

}  // namespace

std::unique_ptr<Importer> makeComma2k19Importer() { return std::make_unique<Comma2k19Importer>(); }

}  // namespace perception
