#include "libperception/app/KittiFiles.h"

#include <fmt/format.h>
#include <zlib.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <string_view>

#include "libperception/core/Error.h"

namespace perception {

namespace {

using Matrix34 = Eigen::Matrix<double, 3, 4>;

/// The fields of one line; every complaint names file, line and column.
class Row {
 public:
  Row(const std::string& path, std::size_t line, std::string_view text, const char* separators)
      : path_(path), line_(line) {
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
      if (end > begin) fields_.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  std::size_t size() const { return fields_.size(); }
  std::string text(std::size_t i) const { return std::string(at(i)); }
  bool isNumber(std::size_t i) const {
    double value = 0;
    return parse(at(i), value);
  }
  double real(std::size_t i) const {
    double value = 0;
    if (!parse(at(i), value) || !std::isfinite(value)) fail(i, "a number");
    return value;
  }
  std::int64_t integer(std::size_t i) const {
    const double value = real(i);
    if (value != std::floor(value) || std::abs(value) > 1e9) fail(i, "a whole number");
    return static_cast<std::int64_t>(value);
  }
  std::int64_t frame(std::size_t i) const {
    const std::int64_t value = integer(i);
    if (value < 0) fail(i, "a frame number of at least 0");
    return value;
  }
  void expect(bool holds, const std::string& expected) const {
    if (!holds)
      throw DataError(fmt::format("{}:{}: {} fields, expected {}", path_, line_, size(), expected));
  }
  [[noreturn]] void fail(std::size_t i, const std::string& expected) const {
    throw DataError(fmt::format("{}:{}: field {}: found '{}', expected {}", path_, line_, i + 1,
                                at(i), expected));
  }
  [[noreturn]] void failLine(const std::string& message) const {
    throw DataError(fmt::format("{}:{}: {}", path_, line_, message));
  }

 private:
  static bool parse(std::string_view s, double& value) {
    if (!s.empty() && s.front() == '+') s.remove_prefix(1);
    const auto result = std::from_chars(s.data(), s.data() + s.size(), value);
    return result.ec == std::errc() && result.ptr == s.data() + s.size();
  }
  std::string_view at(std::size_t i) const {
    if (i >= fields_.size()) failLine(fmt::format("field {} is missing", i + 1));
    return fields_[i];
  }

  const std::string& path_;
  std::size_t line_;
  std::vector<std::string_view> fields_;
};

/// Calls use(row) for each line that is not blank.
void forEachRow(const std::string& path, const char* separators,
                const std::function<void(const Row&)>& use) {
  std::ifstream file(path);
  if (!file) throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const Row row(path, number, line, separators);
    if (row.size() > 0) use(row);
  }
  if (file.bad())
    throw DataError(fmt::format("{}: reading failed: {}", path, std::strerror(errno)));
}

constexpr const char* kSpaces = " \t\r";
constexpr const char* kCommas = ", \t\r";

/// A rigid motion from numbers of limited precision; their rotation is made exactly orthonormal.
Pose3 toRigid(const Row& row, const Matrix34& m) {
  const Eigen::Matrix3d r = m.leftCols<3>();
  if (!(r * r.transpose()).isIdentity(1e-2) || r.determinant() < 0)
    row.failLine("the 3x3 part is no rotation");
  Pose3 pose = Pose3::Identity();
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  pose.translation() = m.col(3);
  return pose;
}

Matrix34 matrix34(const Row& row, std::size_t first) {
  row.expect(row.size() == first + 12, fmt::format("{}", first + 12));
  Matrix34 m;
  for (std::size_t i = 0; i < 12; ++i) {
    m(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = row.real(first + i);
  }
  return m;
}

Pose3 rotation33(const Row& row, std::size_t first) {
  row.expect(row.size() == first + 9, fmt::format("{}", first + 9));
  Matrix34 m = Matrix34::Zero();
  for (std::size_t i = 0; i < 9; ++i) {
    m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) = row.real(first + i);
  }
  return toRigid(row, m);
}

/// KITTI's rectified images differ in size from day to day, and no calibration file says so; the
/// focal length tells the day (image sizes of the raw data's S_rect_02).
struct ImageSize {
  double fx;          ///< [px]
  int width, height;  ///< [px]
};
constexpr ImageSize kImageSizes[] = {{721.5377, 1242, 375},   // 2011_09_26
                                     {707.0493, 1224, 370},   // 2011_09_28
                                     {718.3351, 1238, 374},   // 2011_09_29
                                     {707.0912, 1226, 370},   // 2011_09_30
                                     {718.8560, 1241, 376}};  // 2011_10_03

void setCamera(const Row& row, const Matrix34& P2, KittiCalibration& calibration) {
  CameraModel& c = calibration.camera;
  c.fx = P2(0, 0);
  c.fy = P2(1, 1);
  c.cx = P2(0, 2);
  c.cy = P2(1, 2);
  if (!(c.fx > 0) || !(c.fy > 0) || P2(2, 2) != 1) row.failLine("P2 is not K [I | t] of a camera");
  // P2 = K [I | t]: a point p of cam0 is p + t in cam2.
  const double tz = P2(2, 3);
  const Vector3 t((P2(0, 3) - c.cx * tz) / c.fx, (P2(1, 3) - c.cy * tz) / c.fy, tz);
  calibration.T_cam0_cam2.translation() = -t;
  const auto* best = std::min_element(
      std::begin(kImageSizes), std::end(kImageSizes),
      [&](const auto& a, const auto& b) { return std::abs(a.fx - c.fx) < std::abs(b.fx - c.fx); });
  c.width = best->width;
  c.height = best->height;
}

KittiBox boxFrom(const Row& row, std::size_t first) {
  KittiBox box;
  box.height = row.real(first);
  box.width = row.real(first + 1);
  box.length = row.real(first + 2);
  box.bottom_centre = {row.real(first + 3), row.real(first + 4), row.real(first + 5)};
  box.rotation_y = row.real(first + 6);
  return box;
}

bool isBox(const KittiBox& box) { return box.height > 0 && box.width > 0 && box.length > 0; }

ObjectDetection::ImageBox imageBoxFrom(const Row& row, std::size_t first) {
  return {row.real(first), row.real(first + 1), row.real(first + 2), row.real(first + 3)};
}

/// frame [id] type truncated occluded alpha x1 y1 x2 y2 h w l x y z rotation_y [score]
KittiLabel labelFrom(const Row& row) {
  row.expect(row.size() >= 16 && row.size() <= 18,
             "17 (label) or 18 (with score), or one less without an id");
  const bool has_id = row.isNumber(1);
  const std::size_t type = has_id ? 2 : 1;
  row.expect(row.size() >= type + 15 && row.size() <= type + 16,
             fmt::format("{} or {}", type + 15, type + 16));
  KittiLabel label;
  label.frame = row.frame(0);
  if (has_id) label.id = row.integer(1);
  label.type = row.text(type);
  if (row.isNumber(type)) row.fail(type, "a type such as Car");
  label.truncated = row.real(type + 1);
  label.occluded = static_cast<int>(row.integer(type + 2));
  label.alpha = row.real(type + 3);
  label.image_box = imageBoxFrom(row, type + 4);
  const KittiBox box = boxFrom(row, type + 8);
  if (isBox(box)) label.box = box;
  if (row.size() == type + 16) label.score = row.real(type + 15);
  return label;
}

/// frame,type number,x1,y1,x2,y2,score,h,w,l,x,y,z,rotation_y,alpha
KittiLabel pointRcnnFrom(const Row& row) {
  row.expect(row.size() == 15, "15");
  static constexpr std::array<const char*, 4> kTypes = {"", "Pedestrian", "Car", "Cyclist"};
  const std::int64_t type = row.integer(1);
  if (type < 1 || type > 3) row.fail(1, "1 (Pedestrian), 2 (Car) or 3 (Cyclist)");
  KittiLabel d;
  d.frame = row.frame(0);
  d.type = kTypes[static_cast<std::size_t>(type)];
  d.image_box = imageBoxFrom(row, 2);
  d.score = row.real(6);
  d.box = boxFrom(row, 7);
  if (!isBox(*d.box)) row.failLine("a box whose size is not positive");
  d.alpha = row.real(14);
  return d;
}

/// frame,x1,y1,x2,y2,score; the class is that of the file.
KittiLabel rrcFrom(const Row& row, const std::string& class_name) {
  row.expect(row.size() == 6, "6");
  KittiLabel d;
  d.frame = row.frame(0);
  d.type = class_name;
  d.image_box = imageBoxFrom(row, 1);
  d.score = row.real(5);
  return d;
}

}  // namespace

const std::vector<KittiDetectionLayout>& kittiDetectionLayouts() {
  static const std::vector<KittiDetectionLayout> kLayouts = {
      {"pointrcnn", true, true}, {"pointgnn", true, false}, {"rrc", false, false},
      {"dpm", false, true},      {"kitti3d", true, true},   {"kitti2d", false, true},
  };
  return kLayouts;
}

KittiCalibration readKittiCalibration(const std::string& path) {
  KittiCalibration calibration;
  std::optional<Pose3> rectification, velo_to_cam;
  bool has_camera = false;
  forEachRow(path, " \t\r:", [&](const Row& row) {
    const std::string name = row.text(0);
    // The tracking benchmark's own names and those of the object benchmark.
    if (name == "P2") {
      setCamera(row, matrix34(row, 1), calibration);
      has_camera = true;
    } else if (name == "R0_rect" || name == "R_rect") {
      rectification = rotation33(row, 1);
    } else if (name == "Tr_velo_to_cam" || name == "Tr_velo_cam") {
      velo_to_cam = toRigid(row, matrix34(row, 1));
    } else if (name == "Tr_imu_to_velo" || name == "Tr_imu_velo") {
      calibration.T_velo_imu = toRigid(row, matrix34(row, 1));
    }
  });
  const auto need = [&](bool there, const char* name) {
    if (!there)
      throw DataError(fmt::format("{}: no line {}, expected a KITTI calibration", path, name));
  };
  need(has_camera, "P2");
  need(rectification.has_value(), "R0_rect");
  need(velo_to_cam.has_value(), "Tr_velo_to_cam");
  calibration.T_cam0_velo = *rectification * *velo_to_cam;
  return calibration;
}

std::vector<Pose3> readKittiPoses(const std::string& path, const std::string& format) {
  std::vector<Pose3> poses;
  forEachRow(path, kSpaces, [&](const Row& row) {
    if (format == "kitti") {
      poses.push_back(toRigid(row, matrix34(row, 0)));
      return;
    }
    if (row.text(0).front() == '#') return;
    row.expect(row.size() == 8, "8: t x y z qx qy qz qw");
    const Eigen::Quaterniond q(row.real(7), row.real(4), row.real(5), row.real(6));
    if (std::abs(q.norm() - 1) > 1e-2) row.failLine("qx qy qz qw is no unit quaternion");
    Pose3 pose = Pose3::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = Vector3(row.real(1), row.real(2), row.real(3));
    poses.push_back(pose);
  });
  if (poses.empty()) throw DataError(fmt::format("{}: no pose in it", path));
  return poses;
}

std::vector<Pose3> readKittiOxts(const std::string& path) {
  constexpr double kEarthRadius = 6378137;  // [m] as in the development kit
  std::vector<Pose3> poses;
  double scale = 0;
  forEachRow(path, kSpaces, [&](const Row& row) {
    row.expect(row.size() >= 6, "at least 6: lat lon alt roll pitch yaw ...");
    const double lat = row.real(0), lon = row.real(1);
    if (std::abs(lat) >= 90) row.fail(0, "a latitude in degrees");
    if (std::abs(lon) > 360) row.fail(1, "a longitude in degrees");
    if (poses.empty()) scale = std::cos(radians(lat));
    const double x = scale * radians(lon) * kEarthRadius;
    const double y = scale * kEarthRadius * std::log(std::tan(radians(90 + lat) / 2));
    poses.push_back(makePose(x, y, row.real(2), row.real(5), row.real(4), row.real(3)));
  });
  if (poses.empty()) throw DataError(fmt::format("{}: no pose in it", path));
  return poses;
}

std::vector<KittiLabel> readKittiLabels(const std::string& path) {
  std::vector<KittiLabel> labels;
  forEachRow(path, kSpaces, [&](const Row& row) { labels.push_back(labelFrom(row)); });
  return labels;
}

std::vector<KittiLabel> readKittiDetections(const std::string& path, const std::string& layout,
                                            const std::string& class_name) {
  std::vector<KittiLabel> detections;
  const bool commas = layout == "pointrcnn" || layout == "rrc";
  forEachRow(path, commas ? kCommas : kSpaces, [&](const Row& row) {
    KittiLabel d = layout == "pointrcnn" ? pointRcnnFrom(row)
                   : layout == "rrc"     ? rrcFrom(row, class_name)
                                         : labelFrom(row);
    const bool needs_box = layout == "pointgnn" || layout == "kitti3d";
    if (needs_box && !d.box) row.failLine("a box whose size is not positive");
    if (class_name == "all" || d.type == class_name) detections.push_back(std::move(d));
  });
  return detections;
}

LidarCloud readKittiScan(const std::string& path) {
  constexpr std::size_t kPointBytes = 16;
  constexpr std::size_t kMostBytes = kPointBytes << 24;  // 16 million points: no scanner has them
  const gzFile file = gzopen(path.c_str(), "rb");        // reads plain files, too
  if (file == nullptr)
    throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
  std::vector<char> bytes;
  int got = 0;
  do {
    const std::size_t begin = bytes.size();
    bytes.resize(begin + (1U << 20));
    got = gzread(file, bytes.data() + begin, 1U << 20);
    bytes.resize(begin + static_cast<std::size_t>(std::max(got, 0)));
  } while (got > 0 && bytes.size() <= kMostBytes);
  // A cut gzip file shows only when it is closed.
  const int closed = gzclose(file);
  if (got < 0 || closed != Z_OK) throw DataError(fmt::format("{}: bad or cut gzip data", path));
  if (bytes.size() > kMostBytes || bytes.size() % kPointBytes != 0) {
    throw DataError(fmt::format("{}: {} bytes, expected 16 a point (float32 x, y, z, intensity)",
                                path, bytes.size()));
  }
  LidarCloud cloud;
  const std::size_t n = bytes.size() / kPointBytes;
  for (auto* values : {&cloud.x, &cloud.y, &cloud.z, &cloud.intensity}) values->resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    float point[4];
    std::memcpy(point, bytes.data() + i * kPointBytes, kPointBytes);
    cloud.x[i] = point[0];
    cloud.y[i] = point[1];
    cloud.z[i] = point[2];
    cloud.intensity[i] = point[3];
  }
  cloud.max_range = 120;  // [m] Velodyne HDL-64E, data sheet
  return cloud;
}

ObjectDetection::SpaceBox boxInVelodyne(const KittiBox& box, const KittiCalibration& calibration) {
  const Pose3 T_velo_cam0 = calibration.T_cam0_velo.inverse();
  // rotation_y turns the camera's x axis about its y axis, which points down. With ideal axes yaw =
  // -rotation_y - pi/2; the axis itself also takes the fractions of a degree between the two
  // instruments along.
  const Vector3 axis_cam(std::cos(box.rotation_y), 0, -std::sin(box.rotation_y));
  const Vector3 axis = T_velo_cam0.linear() * axis_cam;
  ObjectDetection::SpaceBox result;
  result.bottom_centre = T_velo_cam0 * box.bottom_centre;
  result.yaw = std::atan2(axis.y(), axis.x());
  result.length = box.length;
  result.width = box.width;
  result.height = box.height;
  return result;
}

int returnsInside(const KittiBox& box, const LidarCloud& cloud,
                  const KittiCalibration& calibration) {
  const double c = std::cos(box.rotation_y), s = std::sin(box.rotation_y);
  // Cheap test first: nothing farther from the bottom centre than the box's diagonal is inside.
  const double reach2 =
      box.length * box.length / 4 + box.width * box.width / 4 + box.height * box.height;
  const Vector3 centre_velo = calibration.T_cam0_velo.inverse() * box.bottom_centre;
  int count = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 point(cloud.x[i], cloud.y[i], cloud.z[i]);
    if (!((point - centre_velo).squaredNorm() <= reach2)) continue;
    const Vector3 d = calibration.T_cam0_velo * point - box.bottom_centre;
    const double along = c * d.x() - s * d.z(), across = s * d.x() + c * d.z();
    if (std::abs(along) <= box.length / 2 && std::abs(across) <= box.width / 2 && d.y() <= 0 &&
        -d.y() <= box.height) {
      ++count;
    }
  }
  return count;
}

}  // namespace perception
