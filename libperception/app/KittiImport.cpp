#include "libperception/app/KittiImport.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationImage.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <utility>

#include "libperception/app/KittiFiles.h"
#include "libperception/core/Error.h"
#include "libperception/sensors/Conversions.h"
#include "libperception/sensors/RawlogWriter.h"
#include "libperception/sensors/ToObservation.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLidarLabel = "LIDAR_TOP";
constexpr const char* kImageLabel = "CAMERA_LEFT";
/// [%] of embedded images: no visible loss.
constexpr int kJpegQuality = 95;
/// [m] Height of the Velodyne on KITTI's car (Geiger et al., IJRR 2013, figure 3).
constexpr double kVelodyneHeight = 1.73;
/// Frame 0 of every sequence: the files carry no date. 2011-09-26 12:00:00 UTC, the day of most
/// recordings.
constexpr Stamp kFirstStamp{1317038400LL * 1'000'000'000};
/// MRPT's clock counts in steps of this.
constexpr std::int64_t kTickNs = 100;

/// Types of the truth that a class of ours covers; the others are neither right nor wrong to
/// report.
const std::set<std::string> kCovered = {
    "Car", "Van", "Truck", "Pedestrian", "Person", "Person_sitting", "Cyclist"};

/// One detector's boxes, by frame.
struct Detector {
  std::string name;
  KittiDetectionLayout layout{};
  std::map<std::int64_t, std::vector<KittiLabel>> by_frame;
};

[[noreturn]] void usage(const std::string& message) { throw Error(ExitCode::kUsage, message); }

/// The layout goes by the name of the detector, or by what stands before its first dash
/// (kitti2d-mine).
const KittiDetectionLayout& layoutOf(const std::string& name) {
  const std::string base = name.substr(0, name.find('-'));
  std::string known;
  for (const auto& layout : kittiDetectionLayouts()) {
    if (layout.name == base) return layout;
    known += (known.empty() ? "" : ", ") + std::string(layout.name);
  }
  usage(fmt::format(
      "--detections: unknown detector '{}', expected one of {} (or one of these and '-anything')",
      name, known));
}

/// The whole import of one sequence.
class Import {
 public:
  Import(const KittiImportParams& params, KittiImportResult& result)
      : params_(params), result_(result) {}
  void run(const std::function<void(std::int64_t, std::int64_t)>& progress);

 private:
  void checkParams() const;
  void readAll();
  void readPoses();
  void readDetections();
  Stamp stampOf(std::int64_t frame) const;
  Pose3 egoAt(std::int64_t frame) const;
  void writeFrame(std::int64_t frame, RawlogWriter& log);
  std::optional<LidarCloud> readScan(std::int64_t frame);
  void writeDetections(std::int64_t frame, RawlogWriter& log);
  void writeImage(std::int64_t frame, RawlogWriter& log);
  void addTruth(std::int64_t frame, const std::optional<LidarCloud>& cloud);
  void setTruthVelocities();
  void warnOfMissing();

  const KittiImportParams& params_;
  KittiImportResult& result_;
  KittiCalibration calibration_;
  Pose3 T_ego_velo_ = makePose(0, 0, kVelodyneHeight, 0);
  Pose3 T_ego_pose_ = Pose3::Identity();  ///< of the frame that the poses are of
  std::vector<Pose3> poses_;              ///< of that frame, in the frame of the file
  std::int64_t last_ = 0;
  std::vector<Detector> detectors_;
  std::map<std::int64_t, std::vector<KittiLabel>> labels_;
  std::vector<TruthObject> truth_;
  std::vector<std::int64_t> missing_scans_, missing_images_;
};

void Import::checkParams() const {
  if (params_.poses.empty() == params_.oxts.empty()) usage("give either --poses or --oxts");
  if (!(params_.rate > 0) || !(params_.rate <= 1e4))
    usage("--rate must be above 0 and at most 10000 Hz");
  if (params_.first < 0) usage("--first must be at least 0");
  if (params_.last >= 0 && params_.last < params_.first) usage("--last is before --first");
  for (const auto* dir : {&params_.lidar_dir, &params_.images_dir}) {
    if (dir->empty()) continue;
    if (!fs::exists(*dir))
      throw DataError(fmt::format("{}: no such folder", *dir), ExitCode::kNoInput);
    if (!fs::is_directory(*dir)) throw DataError(fmt::format("{}: not a folder", *dir));
  }
}

void Import::readPoses() {
  const std::string frame = params_.oxts.empty() ? params_.poses_frame : "imu";
  if (frame == "camera") {
    T_ego_pose_ = T_ego_velo_ * calibration_.T_cam0_velo.inverse();
  } else if (frame == "imu") {
    if (!calibration_.T_velo_imu) {
      throw DataError(fmt::format("{}: no line Tr_imu_to_velo, needed for poses of the IMU",
                                  params_.calibration));
    }
    T_ego_pose_ = T_ego_velo_ * *calibration_.T_velo_imu;
  } else if (frame == "velodyne") {
    T_ego_pose_ = T_ego_velo_;
  } else {
    usage("--poses-frame must be velodyne, camera or imu");
  }
  if (params_.poses_format != "kitti" && params_.poses_format != "tum")
    usage("--poses-format must be kitti or tum");
  poses_ = params_.oxts.empty() ? readKittiPoses(params_.poses, params_.poses_format)
                                : readKittiOxts(params_.oxts);
  const auto end = static_cast<std::int64_t>(poses_.size());
  last_ = params_.last < 0 ? end - 1 : params_.last;
  if (params_.first >= end || last_ >= end) {
    throw DataError(fmt::format("{}: {} poses (frames 0 to {}), but frames {} to {} are wanted",
                                params_.oxts.empty() ? params_.poses : params_.oxts, end, end - 1,
                                params_.first, last_));
  }
}

void Import::readDetections() {
  for (const auto& wanted : params_.detections) {
    const KittiDetectionLayout& layout = layoutOf(wanted.name);
    auto detector = std::find_if(detectors_.begin(), detectors_.end(),
                                 [&](const Detector& d) { return d.name == wanted.name; });
    if (detector == detectors_.end()) {
      detector = detectors_.insert(detectors_.end(), Detector{wanted.name, layout, {}});
      result_.detections[wanted.name] = 0;
    }
    for (auto& d : readKittiDetections(wanted.file, layout.name, wanted.class_name)) {
      detector->by_frame[d.frame].push_back(std::move(d));
    }
  }
}

void Import::readAll() {
  calibration_ = readKittiCalibration(params_.calibration);
  readPoses();
  readDetections();
  if (!params_.labels.empty()) {
    for (auto& label : readKittiLabels(params_.labels))
      labels_[label.frame].push_back(std::move(label));
  }
}

Stamp Import::stampOf(std::int64_t frame) const {
  const double ticks = std::round(static_cast<double>(frame) / params_.rate * (1e9 / kTickNs));
  return {kFirstStamp.ns + static_cast<std::int64_t>(ticks) * kTickNs};
}

Pose3 Import::egoAt(std::int64_t frame) const {
  const Pose3 moved = poses_.front().inverse() * poses_[static_cast<std::size_t>(frame)];
  return T_ego_pose_ * moved * T_ego_pose_.inverse();
}

/// DIR/000012.EXT as in the tracking benchmark or DIR/0000000012.EXT as in the raw data; empty when
/// there is none.
std::string frameFile(const std::string& dir, std::int64_t frame,
                      std::initializer_list<const char*> extensions) {
  for (const auto& name : {fmt::format("{:06}", frame), fmt::format("{:010}", frame)}) {
    for (const char* extension : extensions) {
      const auto path = fs::path(dir) / (name + extension);
      if (fs::exists(path)) return path.string();
    }
  }
  return {};
}

std::optional<LidarCloud> Import::readScan(std::int64_t frame) {
  if (params_.lidar_dir.empty()) return {};
  const std::string path = frameFile(params_.lidar_dir, frame, {".bin", ".bin.gz"});
  if (path.empty()) {
    missing_scans_.push_back(frame);
    return {};
  }
  return readKittiScan(path);
}

void Import::writeFrame(std::int64_t frame, RawlogWriter& log) {
  EgoState ego;
  ego.stamp = stampOf(frame);
  ego.T_world_ego = egoAt(frame);
  ego.uncertainty = {0, 0, 0};  // not known: the site's minimum holds
  log.write(*poseObservation(ego));
  log.write(*frameComment(ego.stamp, frame));
  const std::optional<LidarCloud> cloud = readScan(frame);
  if (cloud) {
    SensorFrame scan;
    scan.sensor = kLidarLabel;
    scan.stamp = ego.stamp;
    scan.T_ego_sensor = T_ego_velo_;
    scan.data = *cloud;
    log.write(*observationFromFrame(scan));
    ++result_.scans;
    result_.points += cloud->size();
  }
  writeDetections(frame, log);
  if (!params_.images_dir.empty()) writeImage(frame, log);
  if (!params_.labels.empty()) addTruth(frame, cloud);
  ++result_.frames;
}

void Import::writeDetections(std::int64_t frame, RawlogWriter& log) {
  const Pose3 T_ego_camera =
      T_ego_velo_ * calibration_.T_cam0_velo.inverse() * calibration_.T_cam0_cam2;
  for (const Detector& detector : detectors_) {
    ObjectDetections found;
    found.camera = calibration_.camera;
    if (detector.layout.space_boxes) found.T_ego_camera = T_ego_camera;
    const auto here = detector.by_frame.find(frame);
    if (here != detector.by_frame.end()) {
      for (const KittiLabel& d : here->second) {
        ObjectDetection& object = found.objects.emplace_back();
        object.label = d.type;
        object.score = d.score;
        if (d.image_box.x2 > d.image_box.x1 && d.image_box.y2 > d.image_box.y1)
          object.image_box = d.image_box;
        if (detector.layout.space_boxes && d.box)
          object.space_box = boxInVelodyne(*d.box, calibration_);
        if (detector.layout.has_alpha && std::abs(d.alpha) <= 2 * kPi)
          object.heading = wrapAngle(d.alpha);
      }
    }
    result_.detections[detector.name] += found.objects.size();
    SensorFrame out;  // also without any object: that nothing was seen is news
    out.sensor = detector.name;
    out.stamp = stampOf(frame);
    out.T_ego_sensor = detector.layout.space_boxes ? T_ego_velo_ : T_ego_camera;
    out.data = std::move(found);
    log.write(*observationFromFrame(out));
  }
}

void Import::writeImage(std::int64_t frame, RawlogWriter& log) {
  const std::string path = frameFile(params_.images_dir, frame, {".png", ".jpg", ".jpeg"});
  if (path.empty()) {
    missing_images_.push_back(frame);
    return;
  }
  const cv::Mat pixels = cv::imread(path, cv::IMREAD_COLOR);
  if (pixels.empty()) throw DataError(fmt::format("{}: not an image", path));
  mrpt::obs::CObservationImage image;
  image.timestamp = fromStamp(stampOf(frame));
  image.sensorLabel = kImageLabel;
  image.cameraPose =
      toMrpt(T_ego_velo_ * calibration_.T_cam0_velo.inverse() * calibration_.T_cam0_cam2);
  auto& camera = image.cameraParams;
  camera.ncols = static_cast<std::uint32_t>(pixels.cols);
  camera.nrows = static_cast<std::uint32_t>(pixels.rows);
  const CameraModel& c = calibration_.camera;
  camera.setIntrinsicParamsFromValues(c.fx, c.fy, c.cx, c.cy);
  if (params_.embed_images) {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);  // MRPT's default is raw pixels
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(kJpegQuality);
    image.image = mrpt::img::CImage(pixels, mrpt::img::DEEP_COPY);
  } else {
    // Beside the log in the folder that MRPT's programs look into; the name alone stands in the
    // log.
    const fs::path folder = fs::path(params_.output).replace_extension().string() + "_Images";
    const fs::path name =
        fmt::format("{}_{:06}{}", kImageLabel, frame, fs::path(path).extension().string());
    std::error_code error;
    fs::create_directories(folder, error);
    if (!error) fs::copy_file(path, folder / name, fs::copy_options::overwrite_existing, error);
    if (error)
      throw OutputError(
          fmt::format("{}: cannot copy: {}", (folder / name).string(), error.message()));
    image.image.setExternalStorage(name.string());
  }
  log.write(image);
  ++result_.images;
}

void Import::addTruth(std::int64_t frame, const std::optional<LidarCloud>& cloud) {
  const auto here = labels_.find(frame);
  if (here == labels_.end()) return;
  const Pose3 T_world_velo = egoAt(frame) * T_ego_velo_;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  for (const KittiLabel& label : here->second) {
    TruthObject& o = truth_.emplace_back();
    o.frame = frame;
    o.t = stampOf(frame) - stampOf(params_.first);
    o.id = label.id;
    o.type = label.type;
    // Tracking labels grade truncation 0, 1, 2 (none, partly, wholly); the object benchmark gives
    // the share itself.
    o.truncated = std::max(0.0, label.truncated > 1 ? label.truncated / 2 : label.truncated);
    o.occluded = std::max(0, label.occluded);
    o.ignore = kCovered.count(label.type) == 0 || !label.box;
    ++result_.truth_types[label.type];
    if (!label.box) {  // an area of the image
      o.position.setConstant(kUnknown);
      o.yaw = o.length = o.width = o.height = kUnknown;
      continue;
    }
    const ObjectDetection::SpaceBox box = boxInVelodyne(*label.box, calibration_);
    const Vector3 axis = T_world_velo.linear() * Vector3(std::cos(box.yaw), std::sin(box.yaw), 0);
    o.position = T_world_velo * box.bottom_centre;
    o.yaw = std::atan2(axis.y(), axis.x());
    o.length = box.length;
    o.width = box.width;
    o.height = box.height;
    if (cloud) o.lidar_points = returnsInside(*label.box, *cloud, calibration_);
  }
}

/// Velocities by differences over the frames beside each row (one side at the ends of a track); a
/// track with a gap starts anew behind it.
void Import::setTruthVelocities() {
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> rows;  // (id, frame) -> row
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    if (truth_[i].id >= 0 && truth_[i].position.allFinite())
      rows[{truth_[i].id, truth_[i].frame}] = i;
  }
  for (const auto& [key, i] : rows) {
    const auto find = [&rows = rows, key = key](std::int64_t step) {
      return rows.find({key.first, key.second + step});
    };
    const auto before = find(-1), after = find(1);
    const TruthObject& a = truth_[before == rows.end() ? i : before->second];
    const TruthObject& b = truth_[after == rows.end() ? i : after->second];
    if (!(b.t > a.t)) continue;
    truth_[i].vx = (b.position.x() - a.position.x()) / (b.t - a.t);
    truth_[i].vy = (b.position.y() - a.position.y()) / (b.t - a.t);
  }
}

void Import::warnOfMissing() {
  const auto report = [this](const std::vector<std::int64_t>& missing, const std::string& dir,
                             const char* what) {
    if (missing.empty()) return;
    const std::string message = fmt::format("{}: no {} for {} of {} frames (first: {})", dir, what,
                                            missing.size(), result_.frames, missing.front());
    if (static_cast<std::int64_t>(missing.size()) == result_.frames)
      throw DataError(message, ExitCode::kNoInput);
    result_.warnings.push_back(message);
  };
  report(missing_scans_, params_.lidar_dir, "scan");
  report(missing_images_, params_.images_dir, "image");
}

void Import::run(const std::function<void(std::int64_t, std::int64_t)>& progress) {
  checkParams();
  readAll();
  RawlogWriter log(params_.output);
  for (std::int64_t frame = params_.first; frame <= last_; ++frame) {
    writeFrame(frame, log);
    if (progress) progress(frame - params_.first + 1, last_ - params_.first + 1);
  }
  warnOfMissing();
  if (!params_.labels.empty()) {  // before the log: where a log is, its truth is whole
    setTruthVelocities();
    result_.truth_rows = truth_.size();
    result_.truth_file = truthFileOf(params_.output);
    writeGroundTruth(result_.truth_file, truth_);
  }
  log.close();
  result_.entries = log.entries();
  result_.bytes = log.bytes();
  result_.bytes_inflated = log.bytesInflated();
}

}  // namespace

std::string truthFileOf(const std::string& rawlog) {
  const fs::path path(rawlog);
  if (path.extension() != ".rawlog") return rawlog + ".truth.csv";
  return fs::path(path).replace_extension(".truth.csv").string();
}

KittiImportResult importKitti(const KittiImportParams& params,
                              const std::function<void(std::int64_t, std::int64_t)>& progress) {
  KittiImportResult result;
  Import(params, result).run(progress);
  return result;
}

}  // namespace perception
