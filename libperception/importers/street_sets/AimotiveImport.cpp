#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/street_sets/AimotiveFiles.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr double kPandarRange = 200;  ///< [m] Hesai Pandar64, data sheet
/// [s] Poses so long before and behind the turns that are wanted tell the velocity at their ends.
constexpr double kAimotivePoseMargin = 0.1;

/// Times are those of a recording without a date.
Stamp stampOf(double t) { return {kUndatedStart.ns + kTickNs * std::llround(t * (1e9 / kTickNs))}; }

/// aiMotive: lidar turns, two radars, a camera, labels and the vehicle's motion as tables.
class AimotiveImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_, "folder with lidar/, scans.csv, calib.json, ego.csv ...")
        ->required();
  }
  void run(ImportLog& log) override;

 private:
  std::string path(const char* name) const { return (fs::path(dir_) / name).string(); }
  bool inside(double t, double margin = 0) const {
    return t >= from_ - margin && t <= to_ + margin;
  }
  double azimuthOf(const Vector3& p) const;  ///< of a point of the body frame, about the lidar
  void queuePoses(const AimotiveEgo& ego, ImportLog& log) const;
  void queueRadar(const char* file, const char* label, const Pose3& T_body_radar,
                  ImportLog& log) const;
  void queueImages(ImportLog& log) const;
  void writeTurn(const AimotiveTurn& turn, ImportLog& log) const;
  std::optional<LidarCloud> readTurn(const AimotiveTurn& turn, ImportLog& log) const;
  void addTruth(const AimotiveTurn& turn, const std::optional<LidarCloud>& cloud,
                ImportLog& log) const;

  std::string dir_;
  AimotiveCalibration calibration_;
  std::optional<AimotiveEgo> ego_;
  std::map<std::int64_t, std::vector<AimotiveBox>> boxes_;
  double from_ = 0, to_ = 0;  ///< [s] of the turns that are wanted
};

double AimotiveImporter::azimuthOf(const Vector3& p) const {
  const Vector3 d = p - calibration_.T_body_lidar.translation();
  return std::atan2(d.y(), d.x());
}

void AimotiveImporter::queuePoses(const AimotiveEgo& ego, ImportLog& log) const {
  for (const AimotiveEgo::State& state : ego.states()) {
    const Stamp stamp = stampOf(state.t);
    const Pose3 pose = state.T_world_body;
    if (inside(state.t, kAimotivePoseMargin))
      log.at(stamp, [stamp, pose, &log] { log.ego(stamp, pose); });
  }
}

void AimotiveImporter::queueRadar(const char* file, const char* label, const Pose3& T_body_radar,
                                  ImportLog& log) const {
  for (AimotiveRadarScan& scan : readAimotiveRadar(path(file))) {
    if (!inside(scan.t)) continue;
    log.at(stampOf(scan.t), [=, &log, returns = std::move(scan.returns), stamp = stampOf(scan.t)] {
      log.sensor(label, stamp, T_body_radar, returns);
    });
  }
}

void AimotiveImporter::queueImages(ImportLog& log) const {
  const std::string dir = path("camera_front");
  if (!fs::exists(dir)) return;
  for (const AimotiveFrame& frame : readAimotiveFrames(path("frames.csv"))) {
    if (!inside(frame.t)) continue;
    const ImportedImage image{kCameraFront,
                              fileOfStem(dir, fmt::format("{:06}", frame.frame), {".jpg", ".png"}),
                              stampOf(frame.t),
                              calibration_.camera,
                              calibration_.T_body_camera,
                              calibration_.distortion};
    if (image.path.empty()) {
      log.missing("image", dir, frame.frame);
      continue;
    }
    log.at(image.stamp, [image, number = frame.frame, &log] { log.image(image, number); });
  }
}

/// In the body frame of each point's own time, as in the file; times about the turn's middle.
std::optional<LidarCloud> AimotiveImporter::readTurn(const AimotiveTurn& turn,
                                                     ImportLog& log) const {
  const std::string dir = path("lidar");
  const std::string file = fileOfStem(dir, fmt::format("{:06}", turn.number), {".bin", ".bin.gz"});
  if (file.empty()) {
    log.missing("scan", dir, turn.number);
    return {};
  }
  CloudFormat format;
  format.max_range = kPandarRange;
  LidarCloud cloud = readCloudFile(file, format);
  if (cloud.size() != turn.points)
    throw DataError(fmt::format("{}: {} points, expected {} as in {}", file, cloud.size(),
                                turn.points, path("scans.csv")));
  cloud.time_offset.resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double azimuth = azimuthOf(Vector3(cloud.x[i], cloud.y[i], cloud.z[i]));
    cloud.time_offset[i] = static_cast<float>(turn.timeOf(azimuth) - turn.middle());
  }
  return cloud;
}

/// Each box stands where it was when the turn passed its center, as its returns do.
void AimotiveImporter::addTruth(const AimotiveTurn& turn, const std::optional<LidarCloud>& cloud,
                                ImportLog& log) const {
  constexpr int kPasses = 3;  // a box moves by less than a degree between two of them
  const Pose3 T_world_body = ego_->at(turn.middle()).T_world_body;
  for (const auto& [id, rows] : boxes_) {
    std::optional<AimotiveBox> found = boxAt(rows, turn.middle());
    for (int k = 0; found && k < kPasses; ++k)
      found = boxAt(rows, turn.timeOf(azimuthOf(found->box.bottom_center)));
    if (!found) continue;
    const AimotiveEgo::State ego = ego_->at(found->t);
    TruthObject o;
    o.frame = turn.number;
    o.id = id;
    o.type = found->type;
    o.ignore = !coveredType(o.type);
    o.occluded = found->occluded;
    o.truncated = found->truncated;
    placeTruth(found->box, T_world_body, o);
    const Vector3& p = found->box.bottom_center;
    const Vector2 over_ground =
        found->relative_velocity + ego.velocity + ego.yaw_rate * Vector2(-p.y(), p.x());
    const Vector2 v = rotate2(yawOf(ego.T_world_body), over_ground);
    o.vx = v.x();
    o.vy = v.y();
    if (cloud) o.lidar_points = returnsInside(found->box, *cloud);
    log.truth(stampOf(turn.middle()), std::move(o));
  }
}

/// Stamped with its middle, when the lidar looks ahead: there the returns lie where the vehicle's
/// pose puts them, behind they are off by half a turn's way.
void AimotiveImporter::writeTurn(const AimotiveTurn& turn, ImportLog& log) const {
  const Stamp stamp = stampOf(turn.middle());
  log.frame(stamp, turn.number);
  const std::optional<LidarCloud> cloud = readTurn(turn, log);
  if (cloud)
    log.sensor(kLidarTop, stamp, calibration_.T_body_lidar,
               inFrame(*cloud, calibration_.T_body_lidar.inverse()));
  addTruth(turn, cloud, log);
}

void AimotiveImporter::run(ImportLog& log) {
  requireFolder(dir_);
  calibration_ = readAimotiveCalibration(path("calib.json"));
  std::vector<AimotiveTurn> turns = readAimotiveTurns(path("scans.csv"));
  turns.erase(std::remove_if(turns.begin(), turns.end(),
                             [&](const auto& t) { return !log.wants(t.number); }),
              turns.end());
  if (turns.empty()) throw DataError(path("scans.csv") + ": none of the wanted turns");
  from_ = turns.front().start;
  to_ = turns.back().end;
  ego_.emplace(path("ego.csv"));
  boxes_ = readAimotiveBoxes(path("boxes.csv"));
  log.expectTruth();
  queuePoses(*ego_, log);
  queueRadar("radar_front.csv", "RADAR_FRONT", calibration_.T_body_radar_front, log);
  queueRadar("radar_rear.csv", "RADAR_REAR", calibration_.T_body_radar_rear, log);
  queueImages(log);
  for (const AimotiveTurn& turn : turns)
    log.at(stampOf(turn.middle()), [this, turn, &log] { writeTurn(turn, log); });
  log.writeInOrder();
  log.note("scans are not compensated for the vehicle's motion: offsets of their points' times");
}

}  // namespace

std::unique_ptr<Importer> makeAimotiveImporter() { return std::make_unique<AimotiveImporter>(); }

}  // namespace perception
