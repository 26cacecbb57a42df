#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/importers/truth/InstanceBoxes.h"
#include "libperception/importers/truth/PointLabelFiles.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

/// A class of the labels: its number where it stands, where it moves (0: never), the truth's type.
struct SemanticClass {
  std::uint32_t standing, moving;
  const char* type;
};
/// Those that are counted one by one, by the data set's own list.
constexpr std::array<SemanticClass, 8> kSemanticThings = {{{10, 252, "Car"},
                                                           {11, 0, "Bicycle"},
                                                           {13, 257, "Bus"},
                                                           {15, 0, "Motorcycle"},
                                                           {18, 258, "Truck"},
                                                           {30, 254, "Pedestrian"},
                                                           {31, 253, "Cyclist"},
                                                           {32, 255, "Motorcyclist"}}};

const SemanticClass* thingOf(std::uint32_t label) {
  for (const SemanticClass& row : kSemanticThings) {
    if (label == row.standing || (row.moving != 0 && label == row.moving)) return &row;
  }
  return nullptr;
}

/// A sequence of SemanticKITTI; labels of points are kept beside the log, those with instances
/// become truth.
class SemanticKittiImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_,
                   "sequences/NN: velodyne/, poses.txt, calib.txt, and where there are labels/, "
                   "times.txt")
        ->required();
  }
  void run(ImportLog& log) override;

 private:
  std::string in(const char* name) const { return (fs::path(dir_) / name).string(); }
  Pose3 lidarInCamera() const;
  std::vector<double> times() const;
  void addLabels(const FrameFile& file, Stamp stamp, const Pose3& T_world_lidar,
                 const LidarCloud& cloud, ImportLog& log);

  std::string dir_;
  InstanceBoxes boxes_;
};

/// Tr of calib.txt.
Pose3 SemanticKittiImporter::lidarInCamera() const {
  std::optional<Pose3> T_cam0_lidar;
  forEachRow(in("calib.txt"), " \t\r:", [&](const TextRow& row) {
    if (row.text(0) == "Tr") T_cam0_lidar = row.pose34(1);
  });
  if (!T_cam0_lidar) throw DataError(in("calib.txt") + ": no line Tr");
  return *T_cam0_lidar;
}

std::vector<double> SemanticKittiImporter::times() const {
  std::vector<double> seconds;
  if (!fs::exists(in("times.txt"))) return seconds;
  forEachRow(in("times.txt"), kSpaces, [&](const TextRow& row) {
    if (!seconds.empty() && row.real(0) <= seconds.back())
      row.failLine("not after the line before");
    seconds.push_back(row.real(0));
  });
  return seconds;
}

void SemanticKittiImporter::addLabels(const FrameFile& file, Stamp stamp,
                                      const Pose3& T_world_lidar, const LidarCloud& cloud,
                                      ImportLog& log) {
  const auto labels = keepPointLabels(dir_, file, cloud.size(), log);
  const Vector2 sensor = T_world_lidar.translation().head<2>();
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::uint32_t label = labels[i] & 0xFFFF, instance = labels[i] >> 16;
    const SemanticClass* const thing = thingOf(label);
    if (thing == nullptr || instance == 0) continue;
    // A number is one object within its class, whether it moves or not is part of the class.
    boxes_.add(labels[i], label == thing->moving, thing->type, file.number, stamp, sensor,
               T_world_lidar * Vector3(cloud.x[i], cloud.y[i], cloud.z[i]));
  }
}

void SemanticKittiImporter::run(ImportLog& log) {
  const auto files = frameFiles(in("velodyne"), {".bin", ".bin.gz"});
  const std::vector<Pose3> poses = readKittiPoses(in("poses.txt"), "kitti");
  const std::vector<double> seconds = times();
  const bool labeled = fs::is_directory(in("labels"));
  const Pose3 T_ego_lidar = makePose(0, 0, kKittiVelodyneHeight, 0);
  const Pose3 T_ego_cam0 = T_ego_lidar * lidarInCamera().inverse();
  if (labeled) log.expectTruth();
  for (const FrameFile& file : files) {
    const auto k = static_cast<std::size_t>(file.number);
    if (k >= poses.size() || (!seconds.empty() && k >= seconds.size()))
      throw DataError(fmt::format(
          "{}: scan {}, but {} has {} lines{}", file.path, file.number, in("poses.txt"),
          poses.size(),
          seconds.empty() ? std::string() : fmt::format(" and times.txt {}", seconds.size())));
    if (!log.wants(file.number)) continue;
    const Stamp stamp = seconds.empty()
                            ? stampAtRate(kUndatedStart, file.number, log.options().rate)
                            : stampAtRate(kUndatedStart + seconds[k], 0, 1);
    const Pose3 T_world_ego =
        T_ego_cam0 * poses.front().inverse() * poses[k] * T_ego_cam0.inverse();
    log.ego(stamp, T_world_ego);
    log.frame(stamp, file.number);
    LidarCloud cloud = readKittiScan(file.path);
    if (labeled) addLabels(file, stamp, T_world_ego * T_ego_lidar, cloud, log);
    log.sensor(kLidarTop, stamp, T_ego_lidar, std::move(cloud));
    log.progress(static_cast<std::int64_t>(&file - files.data()) + 1,
                 static_cast<std::int64_t>(files.size()));
  }
  for (InstanceBoxes::Row& row : boxes_.rows()) {
    row.object.ignore = !coveredType(row.object.type);
    log.truth(row.stamp, std::move(row.object));
  }
  if (!labeled) return log.note("no labels/: no truth");
  log.note(
      "boxes of the truth are fitted about the labeled returns: extents are those of what was "
      "seen");
  log.note("labels, one uint32 a point: " + labelFolderOf(log.options().output));
}

}  // namespace

std::unique_ptr<Importer> makeSemanticKittiImporter() {
  return std::make_unique<SemanticKittiImporter>();
}

}  // namespace perception
