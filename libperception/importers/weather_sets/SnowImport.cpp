#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/kitti/KittiFiles.h"
#include "libperception/importers/truth/LabeledBoxes.h"
#include "libperception/importers/truth/PointLabelFiles.h"
#include "libperception/importers/truth/VehicleAxes.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kSnowScanEndings = {".bin", ".bin.gz"};

/// A data set of scans with a class per point, in SemanticKITTI's layout: DIR/velodyne, DIR/labels,
/// DIR/poses.txt.
struct SnowDataSet {
  std::optional<double> lidar_height;          ///< [m] above the ground; empty: by the returns
  double max_range;                            ///< [m] of the instrument
  std::map<std::uint32_t, const char*> names;  ///< of the labels, for the report
  std::vector<std::string> columns = {"x", "y", "z", "intensity"};
  const char* not_taken = nullptr;  ///< a remark on the rest of the set
};

/// Height: median of the points labeled road within 15 m, 2.14 to 2.23 m over scans 042223 to
/// 042241. Range: the README's. Names: WADS's semantic classes.
const SnowDataSet kWads = {2.17,
                           200,
                           {{0, "unlabeled"},
                            {10, "car"},
                            {20, "other vehicle"},
                            {30, "person"},
                            {40, "road"},
                            {50, "building"},
                            {70, "vegetation"},
                            {80, "pole"},
                            {81, "sign"},
                            {99, "other object"},
                            {110, "falling snow"},
                            {111, "lying snow"}}};
const SnowDataSet kSnowyKitti = {
    kKittiVelodyneHeight, 120, {{0, "surface"}, {1, "snow (simulated)"}}};

/// SemanticSpray and SemanticSpray++: a VLP-32C behind a vehicle on a wet road.
const SnowDataSet kSemanticSpray = {
    {},
    200,
    {{0, "background"}, {1, "vehicle ahead"}, {2, "spray"}},
    {"x", "y", "z", "intensity", "ring"},
    "ibeo_front/, ibeo_rear/, delphi_radar/ and image_2/ are not taken: what their columns are and "
    "where they stand was not at hand"};

/// Imports such a data set; point labels are truth and written beside the log, not into it.
class SnowImporter final : public Importer {
 public:
  explicit SnowImporter(const SnowDataSet& set) : set_(set) {}
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_, "folder with velodyne/, labels/ and, where known, poses.txt")
        ->required();
    auto* const height =
        cli.add_option("--lidar-height", height_,
                       std::string("[m] of the lidar above the ground") +
                           (set_.lidar_height ? "" : "; default: found from its returns"))
            ->check(CLI::Range(0.0, 10.0));
    if (set_.lidar_height) height->default_str(fmt::format("{}", *set_.lidar_height));
  }
  void run(ImportLog& log) override;

 private:
  const SnowDataSet& set_;
  std::string dir_;
  double heightOf(const std::vector<FrameFile>& files, const CloudFormat& format,
                  ImportLog& log) const;
  void addBoxes(const FrameFile& file, Stamp stamp, const Pose3& T_world_lidar,
                const LidarCloud& cloud, BoxTruth& truth) const;
  std::string boxFolder() const { return (fs::path(dir_) / "object_labels" / "lidar").string(); }

  std::optional<double> height_ = set_.lidar_height;
  std::map<std::uint32_t, std::uint64_t> counts_;  ///< points by label
};

double SnowImporter::heightOf(const std::vector<FrameFile>& files, const CloudFormat& format,
                              ImportLog& log) const {
  if (height_) return *height_;
  const auto found =
      heightAboveRoad(files, [&](const std::string& path) { return readCloudFile(path, format); });
  if (!found)
    throw DataError(dir_ + ": the returns do not tell the height of the lidar: --lidar-height");
  log.note(fmt::format("lidar height {:.2f} m, found from its returns (--lidar-height)", *found));
  return *found;
}

/// Boxes of SemanticSpray++.
void SnowImporter::addBoxes(const FrameFile& file, Stamp stamp, const Pose3& T_world_lidar,
                            const LidarCloud& cloud, BoxTruth& truth) const {
  const std::string boxes = fileOfStem(boxFolder(), file.stem, {".json"});
  if (!boxes.empty()) truth.add(readSprayBoxes(boxes), file.number, stamp, T_world_lidar, cloud);
}

void SnowImporter::run(ImportLog& log) {
  const auto files = frameFiles((fs::path(dir_) / "velodyne").string(), kSnowScanEndings);
  const std::string poses_file = (fs::path(dir_) / "poses.txt").string();
  std::vector<Pose3> poses;
  if (fs::exists(poses_file)) {
    poses = readKittiPoses(poses_file, "kitti");
    if (poses.size() != files.size()) {
      throw DataError(fmt::format("{}: {} poses, expected one for each of {} scans", poses_file,
                                  poses.size(), files.size()));
    }
  }
  CloudFormat format;
  format.columns = set_.columns;
  format.intensity_max = 255;  // the README of WADS and SnowyKITTI; the VLP-32C's own
  format.max_range = set_.max_range;
  const Pose3 T_ego_lidar = makePose(0, 0, heightOf(files, format, log), 0);
  BoxTruth truth(log);
  if (fs::is_directory(boxFolder())) log.expectTruth();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const FrameFile& file = files[i];
    if (!log.wants(file.number)) continue;
    const Stamp stamp =
        stampAtRate(kUndatedStart, file.number - files.front().number, log.options().rate);
    const Pose3 T_world_ego =
        poses.empty() ? Pose3::Identity()
                      : T_ego_lidar * poses.front().inverse() * poses[i] * T_ego_lidar.inverse();
    if (!poses.empty()) log.ego(stamp, T_world_ego);
    log.frame(stamp, file.number);
    LidarCloud cloud = readCloudFile(file.path, format);
    for (const std::uint32_t label : keepPointLabels(dir_, file, cloud.size(), log))
      ++counts_[label & 0xFFFF];  // the upper half is an instance
    addBoxes(file, stamp, T_world_ego * T_ego_lidar, cloud, truth);
    log.sensor(kLidarTop, stamp, T_ego_lidar, std::move(cloud));
    log.progress(static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(files.size()));
  }
  if (poses.empty()) log.note("no poses.txt: the vehicle's motion is not known");
  for (const auto& [label, count] : counts_) {
    const auto name = set_.names.find(label);
    log.note(fmt::format("label {} ({}): {} points", label,
                         name == set_.names.end() ? "?" : name->second, count));
  }
  if (set_.not_taken != nullptr) log.note(set_.not_taken);
  if (!counts_.empty())
    log.note("labels, one uint32 a point: " + labelFolderOf(log.options().output));
}

}  // namespace

std::unique_ptr<Importer> makeWadsImporter() { return std::make_unique<SnowImporter>(kWads); }
std::unique_ptr<Importer> makeSemanticSprayImporter() {
  return std::make_unique<SnowImporter>(kSemanticSpray);
}
std::unique_ptr<Importer> makeSnowyKittiImporter() {
  return std::make_unique<SnowImporter>(kSnowyKitti);
}

}  // namespace perception
