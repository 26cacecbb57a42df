#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/PoseSteps.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/clouds/CloudFolder.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/clouds/WorldClouds.h"
#include "libperception/importers/kitti/KittiFiles.h"

namespace perception {
namespace {

/// [s] At the ends of a stamped pose file, the first or last pose is used up to this far in time.
constexpr double kPoseReach = 0.2;
/// [s] Poses are by the clock of the files' names if they begin so near to it.
constexpr double kNearInTime = 3600;

/// A folder of scans in one of the supported formats.
class CloudsImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override;
  void prepare(ImportOptions& options) override { rate_given_ = options.rate > 0; }
  void run(ImportLog& log) override;

 private:
  void readStamps(const std::vector<FrameFile>& files, ImportLog& log);
  bool readStampsOfNames(const std::vector<FrameFile>& files);
  void readViewpoints(const std::vector<FrameFile>& files, ImportLog& log);
  void readPoses(const std::vector<FrameFile>& files, ImportLog& log);
  void findFormat(const std::vector<FrameFile>& files, ImportLog& log);
  std::optional<Pose3> poseAt(std::size_t index) const;
  Pose3 mount() const;

  std::string clouds_, stamps_file_, poses_file_, poses_format_ = "kitti", poses_frame_ = "lidar";
  std::string label_ = "LIDAR_TOP";
  std::vector<double> lidar_pose_{0, 0, 1.73, 0, 0, 0};
  CloudFormat format_;

  std::vector<Stamp> stamps_;         ///< of each file
  std::vector<StampedPose> stamped_;  ///< tum with stamps; else
  std::vector<Pose3> poses_;          ///< one a file
  bool by_number_ = false;            ///< files are missing
  bool rate_given_ = false;
  bool dated_ = false;  ///< stamps_ are times of day, not counted by the rate
};

/// Where files are missing, line k is that of file k, as in KITTI. False: there are fewer lines.
template <class Line>
bool pickByNumber(const std::vector<FrameFile>& files, std::vector<Line>& lines) {
  std::vector<Line> picked;
  for (const FrameFile& file : files) {
    if (file.number < 0 || static_cast<std::size_t>(file.number) >= lines.size()) return false;
    picked.push_back(lines[static_cast<std::size_t>(file.number)]);
  }
  lines = std::move(picked);
  return true;
}

void CloudsImporter::declare(CLI::App& cli) {
  format_.columns.clear();
  cli.add_option("--clouds", clouds_, "folder of scans, one file each, in order of name")
      ->required();
  cli.add_option(
      "--stamps", stamps_file_,
      "a line a file: time since 1970 (s, ms, us, ns), or 2011-09-26 13:02:25.96; without: the "
      "names of the files, if they are such times, else --rate");
  cli.add_option("--poses", poses_file_, "ego motion; without: the vehicle stands");
  cli.add_option("--poses-format", poses_format_,
                 "kitti: 12 numbers (3x4), a line a file; tum: t x y z qx qy qz qw, by time where "
                 "there are --stamps, else a line a file; pcd: the VIEWPOINT of each .pcd file, "
                 "without --poses")
      ->check(CLI::IsMember({"kitti", "tum", "pcd"}))
      ->capture_default_str();
  cli.add_option("--poses-frame", poses_frame_, "whose poses they are")
      ->check(CLI::IsMember({"lidar", "ego"}))
      ->capture_default_str();
  cli.add_option("--lidar-pose", lidar_pose_,
                 "of the lidar on the vehicle: x y z [m], yaw pitch roll [deg]; ego origin: on the "
                 "ground, x forward")
      ->expected(6)
      ->capture_default_str();
  cli.add_option("--label", label_, "sensor label")->capture_default_str();
  cli.add_option("--columns", format_.columns,
                 "of .bin, and of .csv and .npy without names: x y z intensity ring time, others "
                 "are skipped; without: found from the data, and said")
      ->delimiter(',');
  cli.add_option("--intensity-max", format_.intensity_max,
                 "intensities are divided by it; 0: they lie in [0, 1], or are bytes")
      ->check(CLI::Range(0.0, 1e9));
  cli.add_option("--time-scale", format_.time_scale, "[s] of the unit of the column time")
      ->check(CLI::Range(1e-12, 1e3));
  cli.add_option("--max-range", format_.max_range, "[m] of the lidar; 0: not known")
      ->check(CLI::Range(0.0, 1e4));
}

Pose3 CloudsImporter::mount() const {
  const auto& p = lidar_pose_;
  return makePose(p[0], p[1], p[2], radians(p[3]), radians(p[4]), radians(p[5]));
}

/// Recorders name files by their time, 1700000000123456789.bin. Rising numbers from 2000 to 2100
/// are no counts.
bool CloudsImporter::readStampsOfNames(const std::vector<FrameFile>& files) {
  const Stamp least = *stampOfDay("2000-01-01"), most = *stampOfDay("2100-01-01");
  std::vector<Stamp> stamps;
  for (const FrameFile& file : files) {
    const auto stamp = stampOfSeconds(file.stem);
    if (!stamp || *stamp < least || most < *stamp) return false;
    if (!stamps.empty() && *stamp <= stamps.back()) return false;
    stamps.push_back(*stamp);
  }
  stamps_ = std::move(stamps);
  return true;
}

void CloudsImporter::readStamps(const std::vector<FrameFile>& files, ImportLog& log) {
  dated_ = !stamps_file_.empty();
  if (!dated_ && !rate_given_ && files.size() > 1 && readStampsOfNames(files)) {
    dated_ = true;
    return log.note("no --stamps: the files are named by their times, which are taken (--rate)");
  }
  const double rate = log.options().rate;
  for (std::size_t i = 0; i < files.size() && !dated_; ++i)
    stamps_.push_back(stampAtRate(kUndatedStart, files[i].number - files.front().number, rate));
  if (!dated_)
    return log.note(fmt::format("no --stamps: taken as {:g} scans a second (--rate)", rate));
  forEachRow(stamps_file_, kSpaces, [this](const TextRow& row) {
    const std::string date = row.size() > 1 ? row.text(0) + " " + row.text(1) : row.text(0);
    const auto stamp = row.size() == 1 ? stampOfSeconds(row.text(0)) : std::nullopt;
    const auto dated = stamp ? stamp : stampOfDate(date);
    if (!dated)
      row.failLine("expected seconds since 1970 (or ms, us, ns) or 2011-09-26 13:02:25.964");
    if (!stamps_.empty() && *dated <= stamps_.back()) row.failLine("not after the line before");
    stamps_.push_back(*dated);
  });
  if (stamps_.size() == files.size()) return;
  by_number_ = pickByNumber(files, stamps_);
  if (!by_number_) {
    throw DataError(fmt::format("{}: {} stamps, expected one for each of {} clouds of {}",
                                stamps_file_, stamps_.size(), files.size(), clouds_));
  }
}

/// PCL stores the pose of the sensor beside the points, which stay in the sensor's frame.
void CloudsImporter::readViewpoints(const std::vector<FrameFile>& files, ImportLog& log) {
  if (poses_format_ != "pcd") {
    const auto last = viewpointOf(files.back().path);
    if (last && !last->isApprox(Pose3::Identity(), 1e-9))
      log.note(fmt::format(
          "the VIEWPOINT of {} is not used: --poses-format pcd takes the VIEWPOINTs as poses",
          files.back().path));
    return;
  }
  if (!poses_file_.empty())
    failUsage("--poses-format pcd reads the poses from the .pcd files: leave out --poses");
  for (const FrameFile& file : files) {
    const auto pose = viewpointOf(file.path);
    if (!pose) throw DataError(file.path + ": no pose, expected VIEWPOINT x y z qw qx qy qz");
    poses_.push_back(*pose);
  }
}

/// Quaternions in the other order turn a vehicle on its back.
bool areUpsideDown(const std::vector<StampedPose>& poses) {
  constexpr double kDown = -0.5;
  return std::all_of(poses.begin(), poses.end(),
                     [](const StampedPose& p) { return p.pose.linear()(2, 2) < kDown; });
}

void CloudsImporter::readPoses(const std::vector<FrameFile>& files, ImportLog& log) {
  if (poses_file_.empty()) return;
  if (poses_format_ == "tum") {
    stamped_ = readTumPoses(poses_file_);
    if (areUpsideDown(stamped_) && mount().linear()(2, 2) > 0)
      log.warn(
          fmt::format("{}: all poses stand upside down; expected t x y z qx qy qz qw: are they "
                      "t x y z qw qx qy qz?",
                      poses_file_));
    const bool by_time =
        dated_ &&
        (!stamps_file_.empty() || std::abs(stamped_.front().stamp - stamps_.front()) < kNearInTime);
    for (std::size_t i = 1; i < stamped_.size() && by_time; ++i) {
      if (stamped_[i].stamp <= stamped_[i - 1].stamp)
        throw DataError(
            fmt::format("{}: pose {} is not later than the one before", poses_file_, i));
    }
    if (by_time) return;
    for (const StampedPose& p : stamped_) poses_.push_back(p.pose);
    stamped_.clear();
  } else {
    poses_ = readKittiPoses(poses_file_, poses_format_);
  }
  if (poses_.size() == files.size()) return;
  by_number_ = pickByNumber(files, poses_);
  if (!by_number_) {
    throw DataError(fmt::format("{}: {} poses, expected one for each of {} clouds of {}",
                                poses_file_, poses_.size(), files.size(), clouds_));
  }
}

/// Pose of the frame that the file's poses refer to; empty outside of the file.
std::optional<Pose3> CloudsImporter::poseAt(std::size_t index) const {
  if (!poses_.empty()) return poses_[index];
  if (stamped_.empty()) return {};
  const Stamp stamp = stamps_[index];
  const auto after = std::lower_bound(stamped_.begin(), stamped_.end(), stamp,
                                      [](const StampedPose& p, Stamp t) { return p.stamp < t; });
  if (after == stamped_.begin() || after == stamped_.end()) {
    const StampedPose& end = after == stamped_.end() ? stamped_.back() : stamped_.front();
    if (std::abs(end.stamp - stamp) > kPoseReach) return {};
    return end.pose;
  }
  const StampedPose& before = *std::prev(after);
  const double share = (stamp - before.stamp) / (after->stamp - before.stamp);
  return interpolate(before.pose, after->pose, share);
}

/// All scans have the format of the first ones.
void CloudsImporter::findFormat(const std::vector<FrameFile>& files, ImportLog& log) {
  const bool given = !format_.columns.empty();
  std::vector<std::string> paths;
  for (const FrameFile& file : files) paths.push_back(file.path);
  format_ = foundFormat(paths, format_);
  if (format_.doubles) log.note("the numbers look like float64 (double), and are read as such");
  if (given || format_.columns.empty()) return;  // the files name their columns
  const std::string scale =
      format_.intensity_max > 1 ? fmt::format(", intensity up to {:g}", format_.intensity_max) : "";
  log.note(fmt::format("columns found from the data: {}{} (--columns says otherwise)",
                       fmt::join(format_.columns, " "), scale));
}

void CloudsImporter::run(ImportLog& log) {
  const CloudFiles found = cloudFilesIn(clouds_);
  const std::vector<FrameFile>& files = found.scans;
  if (!found.others.empty())
    log.note(fmt::format("no scans by their names: {} files of {}, such as {}", found.others.size(),
                         clouds_, found.others.front()));
  readStamps(files, log);
  readViewpoints(files, log);
  readPoses(files, log);
  const auto missing = files.back().number + 1 - static_cast<std::int64_t>(files.size());
  if (by_number_)
    log.note(
        fmt::format("{} files are missing: line k of stamps and poses is that of file k", missing));
  const Pose3 T_ego_lidar = mount();
  const Pose3 T_ego_pose = poses_frame_ == "ego" ? Pose3::Identity() : T_ego_lidar;
  const bool has_poses = !poses_.empty() || !stamped_.empty();
  if (!has_poses) log.note("no --poses: the vehicle is taken to stand still");
  findFormat(files, log);
  // World: the ego frame at the first pose of the file.
  const Pose3 origin = !has_poses         ? Pose3::Identity()
                       : stamped_.empty() ? poses_.front()
                                          : stamped_.front().pose;
  std::vector<PlacedFile> placed;
  for (std::size_t i = 0; i < files.size(); ++i)
    if (const auto pose = poseAt(i)) placed.push_back({files[i].path, pose->translation()});
  const bool in_world = areInWorld(placed, format_);
  if (in_world)
    log.note(
        "the returns lie about the places of the poses, in whose frame they are: moved back to the "
        "lidar");
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (!log.wants(files[i].number)) continue;
    const auto pose = poseAt(i);
    if (pose) {
      log.ego(stamps_[i], T_ego_pose * origin.inverse() * *pose * T_ego_pose.inverse());
    } else if (has_poses) {
      log.missing("pose", poses_file_, files[i].number);
    }
    log.frame(stamps_[i], files[i].number);
    LidarCloud cloud = readCloudFile(files[i].path, format_);
    if (in_world && pose)
      cloud = inFrame(std::move(cloud), T_ego_lidar.inverse() * T_ego_pose * pose->inverse());
    if (!in_world || pose) log.sensor(label_, stamps_[i], T_ego_lidar, std::move(cloud));
    log.progress(static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(files.size()));
  }
}

}  // namespace

std::unique_ptr<Importer> makeCloudsImporter() { return std::make_unique<CloudsImporter>(); }

}  // namespace perception
