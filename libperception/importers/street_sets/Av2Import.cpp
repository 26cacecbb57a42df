#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/PoseSteps.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/truth/TruthTypes.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLidarName = "up_lidar";  ///< whose place is the scan's
/// [m] Of the data set's vehicle frame (rear axle) above the road: planes through the returns of
/// the example's three scans within 12 m lie 0.336, 0.333 and 0.327 m below it.
constexpr double kOriginHeight = 0.33;
/// [m] Velodyne VLP-32C: 200 m by its data sheet; the example reaches 219 m.
constexpr double kVlp32Range = 220;

/// A pose of columns qw qx qy qz and a place of three columns.
Pose3 poseOf(const CsvTable& table, std::size_t row, const std::array<const char*, 3>& place) {
  const auto at = [&](const char* column) { return table.real(row, table.column(column)); };
  const auto pose = poseFrom({at(place[0]), at(place[1]), at(place[2])},
                             {at("qw"), at("qx"), at("qy"), at("qz")});
  if (!pose)
    throw DataError(
        fmt::format("{}:{}: qw to qz: no unit quaternion", table.name(), table.lineOf(row)));
  return *pose;
}

/// A line of scans.csv.
struct Av2Scan {
  std::int64_t number = 0;
  std::string log;
  Stamp stamp;
  std::uint64_t points = 0;
  Pose3 T_city_vehicle = Pose3::Identity();
};

/// Scans of Argoverse 2 as tables: lidar/NNNNNN.bin[.gz], scans.csv, boxes.csv, calib.csv.
class Av2Importer final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_, "folder with lidar/, scans.csv, boxes.csv, calib.csv")
        ->required();
    cli.add_option("--log", log_id_,
                   "ID of the log that is wanted, or how it begins; default: all, one after the "
                   "other");
  }
  void run(ImportLog& log) override;

 private:
  /// Scans of one drive; the pose of the first one is its world's.
  struct Drive {
    std::vector<Av2Scan> scans;
    Stamp begin;
    Pose3 T_world_city = Pose3::Identity();
  };
  std::string path(const char* name) const { return (fs::path(dir_) / name).string(); }
  std::vector<Av2Scan> readScans(const ImportOptions& options) const;
  void readBoxes();
  void readCalibration();
  std::vector<Drive> drivesOf(std::vector<Av2Scan> scans, int repeat) const;
  std::optional<LidarCloud> readCloud(const Av2Scan& scan, ImportLog& log) const;
  void writeDrive(const Drive& drive, ImportLog& log) const;
  void writeScan(const Drive& drive, const Av2Scan& scan, Stamp stamp, ImportLog& log) const;
  Pose3 egoOf(const Drive& drive, const Av2Scan& scan) const {
    return drive.T_world_city * scan.T_city_vehicle * T_ego_vehicle_.inverse();
  }

  std::string dir_, log_id_;
  Pose3 T_ego_vehicle_ = makePose(0, 0, kOriginHeight, 0);
  Pose3 T_vehicle_lidar_ = Pose3::Identity();
  std::map<std::int64_t, std::vector<TruthObject>> boxes_;  ///< by scan, vehicle frame
};

std::vector<Av2Scan> Av2Importer::readScans(const ImportOptions& options) const {
  const CsvTable table = CsvTable::fromFile(path("scans.csv"));
  const auto scan = table.column("scan"), id = table.column("log"),
             stamp = table.column("timestamp_ns"), points = table.column("points");
  std::vector<Av2Scan> scans;
  bool known = false;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    Av2Scan s;
    s.number = table.integer(i, scan);
    s.log = table.text(i, id);
    s.stamp.ns = kTickNs * ((table.integer(i, stamp) + kTickNs / 2) / kTickNs);
    s.points = table.natural(i, points);
    s.T_city_vehicle = poseOf(table, i, {"tx", "ty", "tz"});
    if (s.number < 0) table.fault(i, scan, "a scan number of at least 0");
    if (!scans.empty() && s.log == scans.back().log && s.stamp <= scans.back().stamp)
      table.fault(i, stamp, "a later stamp than the scan before it");
    if (s.log.rfind(log_id_, 0) != 0) continue;
    known = true;
    if (options.wants(s.number)) scans.push_back(std::move(s));
  }
  if (!known && !log_id_.empty())
    failUsage(fmt::format("--log {}: no such log in {}", log_id_, table.name()));
  if (scans.empty()) throw DataError(table.name() + ": none of the wanted scans");
  return scans;
}

void Av2Importer::readBoxes() {
  const CsvTable table = CsvTable::fromFile(path("boxes.csv"));
  const auto track = table.column("track"), category = table.column("category");
  const auto scan = table.column("scan");
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto at = [&](const char* column) { return table.real(i, table.column(column)); };
    const auto size = [&](const char* column) {
      if (!(at(column) > 0)) table.fault(i, table.column(column), "a size above 0");
      return at(column);
    };
    TruthObject o;
    const std::string_view id = table.text(i, track);
    const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), o.id, 16);
    if (error != std::errc() || end != id.data() + id.size() || o.id < 0 || id.size() > 8)
      table.fault(i, track, "up to 8 hexadecimal digits");
    o.frame = table.integer(i, scan);
    if (table.text(i, category).empty()) table.fault(i, category, "a category such as PEDESTRIAN");
    o.type = truthTypeOf(std::string(table.text(i, category)));
    o.ignore = !coveredType(o.type);
    o.length = size("length");
    o.width = size("width");
    o.height = size("height");
    o.position = Vector3(at("x"), at("y"), at("z") - o.height / 2);
    o.yaw = wrapAngle(at("yaw"));
    boxes_[o.frame].push_back(std::move(o));
  }
}

void Av2Importer::readCalibration() {
  const CsvTable table = CsvTable::fromFile(path("calib.csv"));
  const auto name = table.column("sensor_name");
  for (std::size_t i = 0; i < table.rows(); ++i) {
    if (table.text(i, name) != kLidarName) continue;
    T_vehicle_lidar_ = poseOf(table, i, {"tx_m", "ty_m", "tz_m"});
    return;
  }
  throw DataError(fmt::format("{}: no row {}", table.name(), kLidarName));
}

/// Drives begin at places and times of their own: nothing of one is anything of the next. The first
/// keeps its stamps. A scan that is shown repeatedly is a drive of its own.
std::vector<Av2Importer::Drive> Av2Importer::drivesOf(std::vector<Av2Scan> scans,
                                                      int repeat) const {
  std::vector<Drive> drives;
  Stamp last;
  for (Av2Scan& scan : scans) {
    if (drives.empty() || repeat > 1 || scan.log != drives.back().scans.front().log) {
      const double place = kAloneDistance * static_cast<double>(drives.size());
      const Stamp begin = drives.empty() ? scan.stamp : last + 1 / kAloneRate;
      Drive& drive = drives.emplace_back();
      drive.begin = begin;
      drive.T_world_city =
          makePose(place, 0, 0, 0) * (scan.T_city_vehicle * T_ego_vehicle_.inverse()).inverse();
    }
    Drive& drive = drives.back();
    drive.scans.push_back(std::move(scan));
    last = drive.begin + (drive.scans.back().stamp - drive.scans.front().stamp);
    last = stampAtRate(last, repeat - 1, kRepeatRate);
  }
  return drives;
}

std::optional<LidarCloud> Av2Importer::readCloud(const Av2Scan& scan, ImportLog& log) const {
  const std::string dir = path("lidar");
  const std::string file = fileOfStem(dir, fmt::format("{:06}", scan.number), {".bin", ".bin.gz"});
  if (file.empty()) {
    log.missing("scan", dir, scan.number);
    return {};
  }
  CloudFormat format;
  format.max_range = kVlp32Range;
  LidarCloud cloud = readCloudFile(file, format);
  if (cloud.size() != scan.points)
    throw DataError(fmt::format("{}: {} points, expected {} as in {}", file, cloud.size(),
                                scan.points, path("scans.csv")));
  return cloud;
}

/// The last showing carries number and truth.
void Av2Importer::writeScan(const Drive& drive, const Av2Scan& scan, Stamp stamp,
                            ImportLog& log) const {
  const Pose3 T_world_ego = egoOf(drive, scan);
  const std::optional<LidarCloud> cloud = readCloud(scan, log);
  SensorFrame out;
  out.sensor = kLidarTop;
  out.T_ego_sensor = T_ego_vehicle_ * T_vehicle_lidar_;
  if (cloud) out.data = inFrame(*cloud, T_vehicle_lidar_.inverse());
  for (int k = 1; k <= log.options().repeat; ++k) {
    out.stamp = stampAtRate(stamp, k - 1, kRepeatRate);
    log.ego(out.stamp, T_world_ego);
    if (k == log.options().repeat) log.frame(out.stamp, scan.number);
    if (cloud) log.sensor(out);
  }
  const auto boxes = boxes_.find(scan.number);
  if (boxes == boxes_.end()) return;
  for (TruthObject object : boxes->second) {
    const ObjectDetection::SpaceBox box{object.position, object.yaw, object.length, object.width,
                                        object.height};
    placeTruth(box, T_world_ego * T_ego_vehicle_, object);
    if (cloud) object.lidar_points = returnsInside(box, *cloud);
    log.truth(out.stamp, std::move(object));
  }
}

/// Poses before and behind a drive carry its speed on: between drives nothing is driven.
void Av2Importer::writeDrive(const Drive& drive, ImportLog& log) const {
  const auto& scans = drive.scans;
  const auto stampOf = [&](const Av2Scan& scan) {
    return drive.begin + (scan.stamp - scans.front().stamp);
  };
  const auto carry = [&](const Av2Scan& end, const Av2Scan& inner, Stamp stamp, double dt) {
    const double step = end.stamp - inner.stamp;
    const double share = step == 0 ? 0 : std::abs(dt / step);
    log.ego(stamp + dt, interpolate(egoOf(drive, end), egoOf(drive, inner), -share));
  };
  const std::size_t second = std::min<std::size_t>(1, scans.size() - 1);
  carry(scans.front(), scans[second], drive.begin, -kStillPoses);
  for (const Av2Scan& scan : scans) writeScan(drive, scan, stampOf(scan), log);
  const Stamp end = stampAtRate(stampOf(scans.back()), log.options().repeat - 1, kRepeatRate);
  carry(scans.back(), scans[scans.size() - 1 - second], end, kStillPoses);
}

void Av2Importer::run(ImportLog& log) {
  requireFolder(dir_);
  readCalibration();
  readBoxes();
  const auto drives = drivesOf(readScans(log.options()), log.options().repeat);
  log.expectTruth();
  std::int64_t done = 0;
  for (const Drive& drive : drives) {
    writeDrive(drive, log);
    log.progress(++done, static_cast<std::int64_t>(drives.size()));
  }
  log.note(fmt::format("{} drives, each with a place and a time of its own", drives.size()));
}

}  // namespace

std::unique_ptr<Importer> makeAv2Importer() { return std::make_unique<Av2Importer>(); }

}  // namespace perception
