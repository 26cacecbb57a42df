#include "libperception/importers/ImportLog.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationImage.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "libperception/core/Error.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/images/ImageFile.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

/// [%] of embedded images: no visible loss.
constexpr int kJpegQuality = 95;
/// [s] Largest time between rows of one object for a velocity by differences.
constexpr double kTruthGap = 1.0;

void failImage(const fs::path& path, const char* what, const std::error_code& error) {
  throw OutputError(fmt::format("{}: cannot {}: {}", path.string(), what, error.message()));
}

}  // namespace

ImportLog::ImportLog(ImportOptions options, ImportProgress progress)
    : options_(std::move(options)), progress_(std::move(progress)), log_(options_.output) {
  if (options_.rate <= 0) options_.rate = kUsualRate;
}

void ImportLog::write(const mrpt::obs::CObservation& observation) {
  if (const auto stamp = toStamp(observation.timestamp)) {
    if (!first_stamp_ || *stamp < *first_stamp_) first_stamp_ = *stamp;
  }
  log_.write(observation);
}

void ImportLog::observation(const mrpt::obs::CObservation& observation) {
  write(observation);
  ++result_.others[observation.sensorLabel];
}

void ImportLog::ego(Stamp stamp, const Pose3& T_world_ego, const PoseUncertainty& uncertainty) {
  EgoState ego;
  ego.stamp = stamp;
  ego.T_world_ego = T_world_ego;
  ego.uncertainty = uncertainty;
  write(*poseObservation(ego));
  ++result_.poses;
}

bool ImportLog::wants(std::int64_t frame) {
  if (!numbers_) numbers_.emplace(frame, frame);
  numbers_->first = std::min(numbers_->first, frame);
  numbers_->second = std::max(numbers_->second, frame);
  const bool wanted = options_.wants(frame);
  any_wanted_ = any_wanted_ || wanted;
  return wanted;
}

void ImportLog::failWithoutFrames() const {
  if (any_wanted_ || !numbers_) return;
  const std::string last = options_.last < 0 ? "" : fmt::format(" --last {}", options_.last);
  throw DataError(
      fmt::format("no frame is within --first {}{}: the recording has the frames {} to {}",
                  options_.first, last, numbers_->first, numbers_->second),
      ExitCode::kNoInput);
}

void ImportLog::frame(Stamp stamp, std::int64_t number) {
  write(*frameComment(stamp, number));
  ++result_.frames;
}

void ImportLog::sensor(const SensorFrame& frame) {
  if (!doubles_.isDouble(frame)) uniqueSensor(frame);
}

void ImportLog::sensor(const std::string& label, Stamp stamp, const Pose3& T_ego_sensor,
                       decltype(SensorFrame::data) data) {
  SensorFrame frame;
  frame.sensor = label, frame.stamp = stamp, frame.T_ego_sensor = T_ego_sensor;
  frame.data = std::move(data);
  sensor(frame);
}

void ImportLog::uniqueSensor(const SensorFrame& frame) {
  const auto mended = oddities_.mended(frame);
  writeSensor(mended ? *mended : frame);
}

void ImportLog::writeSensor(const SensorFrame& frame) {
  if (const auto* cloud = std::get_if<LidarCloud>(&frame.data)) {
    ++result_.scans;
    result_.points += cloud->size();
  } else if (const auto* radar = std::get_if<RadarReturns>(&frame.data)) {
    ++result_.radar_scans;
    result_.radar_returns += radar->returns.size();
  } else if (const auto* found = std::get_if<ObjectDetections>(&frame.data)) {
    result_.detections[frame.sensor] += found->objects.size();
  } else {
    ++result_.images;
  }
  write(*observationFromFrame(frame));
}

/// The image's name in the log, relative to FILE_Images.
std::string ImportLog::storedImage(const ImportedImage& image, std::int64_t frame) {
  const fs::path folder = imageFolderOf(options_.output);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) failImage(folder, "create", error);
  if (options_.images == ImportOptions::Images::kCopy) {
    const fs::path name =
        fmt::format("{}_{:06}{}", image.label, frame, fs::path(image.path).extension().string());
    fs::copy_file(image.path, folder / name, fs::copy_options::overwrite_existing, error);
    if (error) failImage(folder / name, "copy", error);
    return name.string();
  }
  // One link a camera: MRPT's programs find the files, and log and recording can move together.
  const fs::path source = fs::absolute(image.path).parent_path(), link = folder / image.label;
  std::string& linked = linked_[image.label];
  if (linked != source.string()) {
    if (!linked.empty())
      throw OutputError(
          fmt::format("{}: images of one camera in two folders: copy or embed them", image.path));
    if (fs::is_symlink(link)) fs::remove(link, error);
    fs::create_directory_symlink(fs::relative(source, fs::canonical(folder)), link, error);
    if (error) failImage(link, "link the images' folder (copy or embed them)", error);
    linked = source.string();
  }
  return (fs::path(image.label) / fs::path(image.path).filename()).string();
}

void ImportLog::image(const ImportedImage& in, std::int64_t frame) {
  const cv::Mat pixels = readImageFile(in.path, cv::IMREAD_COLOR);
  if (pixels.empty()) throw DataError(fmt::format("{}: not an image", in.path));
  mrpt::obs::CObservationImage out;
  out.timestamp = fromStamp(in.stamp);
  out.sensorLabel = in.label;
  out.cameraPose = toMrpt(in.T_ego_camera);
  auto& camera = out.cameraParams;
  camera.ncols = static_cast<std::uint32_t>(pixels.cols);
  camera.nrows = static_cast<std::uint32_t>(pixels.rows);
  camera.setIntrinsicParamsFromValues(in.camera.fx, in.camera.fy, in.camera.cx, in.camera.cy);
  for (std::size_t i = 0; i < std::min<std::size_t>(5, in.distortion.size()); ++i)
    camera.dist[i] = in.distortion[i];
  if (options_.images == ImportOptions::Images::kEmbed) {
    mrpt::img::CImage::DISABLE_JPEG_COMPRESSION(false);  // MRPT's default is raw pixels
    mrpt::img::CImage::SERIALIZATION_JPEG_QUALITY(kJpegQuality);
    out.image = mrpt::img::CImage(pixels, mrpt::img::DEEP_COPY);
  } else {
    out.image.setExternalStorage(storedImage(in, frame));
  }
  write(out);
  ++result_.images;
}

void ImportLog::at(Stamp stamp, std::function<void()> write) {
  queue_.emplace_back(stamp, std::move(write));
}

void ImportLog::writeInOrder() {
  std::stable_sort(queue_.begin(), queue_.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    queue_[i].second();
    progress(static_cast<std::int64_t>(i + 1), static_cast<std::int64_t>(queue_.size()));
  }
  queue_.clear();
}

void ImportLog::truth(Stamp stamp, TruthObject object) {
  has_truth_ = true;
  ++result_.truth_types[object.type];
  truth_.emplace_back(stamp, std::move(object));
}

void ImportLog::missing(const std::string& what, const std::string& dir, std::int64_t frame) {
  const std::pair<std::string, std::string> key{dir, what};
  auto row =
      std::find_if(missing_.begin(), missing_.end(), [&](const auto& m) { return m.first == key; });
  if (row == missing_.end()) row = missing_.insert(missing_.end(), {key, {}});
  row->second.push_back(frame);
}

void ImportLog::progress(std::int64_t done, std::int64_t total) const {
  if (progress_) progress_(done, total);
}

void ImportLog::warnOfMissing() {
  for (const auto& [key, frames] : missing_) {
    const std::string message =
        fmt::format("{}: no {} for {} of {} frames (first: {})", key.first, key.second,
                    frames.size(), result_.frames, frames.front());
    if (static_cast<std::int64_t>(frames.size()) >= result_.frames)
      throw DataError(message, ExitCode::kNoInput);
    warn(message);
  }
}

/// Velocities by differences over the rows beside each row (one side at the ends of a track), where
/// the recording gives none; a track with a gap starts anew behind it.
void ImportLog::setTruthVelocities() {
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> rows;  // (id, frame) -> row
  for (std::size_t i = 0; i < truth_.size(); ++i) {
    const TruthObject& o = truth_[i].second;
    if (o.id >= 0 && o.position.allFinite()) rows[{o.id, o.frame}] = i;
  }
  for (const auto& [key, i] : rows) {
    TruthObject& o = truth_[i].second;
    if (std::isfinite(o.vx)) continue;
    const auto find = [&rows = rows, key = key](std::int64_t step) {
      return rows.find({key.first, key.second + step});
    };
    const auto before = find(-1), after = find(1);
    const TruthObject& a = truth_[before == rows.end() ? i : before->second].second;
    const TruthObject& b = truth_[after == rows.end() ? i : after->second].second;
    if (!(b.t > a.t) || b.t - a.t > 2 * kTruthGap) continue;
    o.vx = (b.position.x() - a.position.x()) / (b.t - a.t);
    o.vy = (b.position.y() - a.position.y()) / (b.t - a.t);
  }
}

ImportResult ImportLog::close() {
  failWithoutFrames();
  warnOfMissing();
  for (const auto& [label, count] : doubles_.counts())
    note(fmt::format(
        "{}: {} messages came twice, with the same content and stamp (within 20 ms): left out",
        label, count));
  oddities_.tell(result_.notes, result_.warnings);
  log_.finish();
  if (has_truth_) {  // before the log has its name, so that a complete log has its truth
    std::vector<TruthObject> objects;
    for (auto& [stamp, object] : truth_) object.t = stamp - first_stamp_.value_or(stamp);
    setTruthVelocities();
    for (auto& row : truth_) objects.push_back(std::move(row.second));
    result_.truth_rows = objects.size();
    result_.truth_file = truthFileOf(options_.output);
    writeGroundTruth(result_.truth_file, objects);
  }
  log_.close();
  result_.entries = log_.entries();
  result_.bytes = log_.bytes();
  result_.bytes_inflated = log_.bytesInflated();
  return result_;
}

std::string imageFolderOf(const std::string& rawlog) { return imagesBeside(rawlog); }

bool coveredType(const std::string& type) {
  static const std::set<std::string> kCovered = {
      "Car", "Van", "Truck", "Bus", "Pedestrian", "Person", "Person_sitting", "Cyclist"};
  return kCovered.count(type) > 0;
}

int returnsInside(const ObjectDetection::SpaceBox& box, const LidarCloud& cloud) {
  int count = 0;
  const double reach = std::hypot(box.length, box.width) / 2;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double dx = cloud.x[i] - box.bottom_center.x(), dy = cloud.y[i] - box.bottom_center.y();
    const double dz = cloud.z[i] - box.bottom_center.z();
    if (!(dz >= 0) || !(dz <= box.height) || !(std::hypot(dx, dy) <= reach)) continue;
    const Vector2 d = rotate2(-box.yaw, {dx, dy});
    if (std::abs(d.x()) <= box.length / 2 && std::abs(d.y()) <= box.width / 2) ++count;
  }
  return count;
}

void placeTruth(const ObjectDetection::SpaceBox& box, const Pose3& T_world_sensor, TruthObject& o) {
  const Vector3 axis = T_world_sensor.linear() * Vector3(std::cos(box.yaw), std::sin(box.yaw), 0);
  o.position = T_world_sensor * box.bottom_center;
  o.yaw = std::atan2(axis.y(), axis.x());
  o.length = box.length;
  o.width = box.width;
  o.height = box.height;
}

}  // namespace perception
