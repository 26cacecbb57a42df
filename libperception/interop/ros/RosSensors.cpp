#include "libperception/interop/ros/RosSensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/LowerCase.h"
#include "libperception/measurement/frames/ScanTimes.h"

namespace perception::ros {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};  // [bytes] by PointField::Type

template <class Number>
double numberAt(const char* bytes) {
  Number value;
  std::memcpy(&value, bytes, sizeof(Number));
  return static_cast<double>(value);
}

/// `big`: the number's first byte is its most significant one.
double valueAt(const char* bytes, std::uint8_t type, bool big) {
  char turned[8];
  if (big) {
    std::reverse_copy(bytes, bytes + kSizes[type], turned);
    bytes = turned;
  }
  switch (type) {
    case PointField::kI8:
      return numberAt<std::int8_t>(bytes);
    case PointField::kU8:
      return numberAt<std::uint8_t>(bytes);
    case PointField::kI16:
      return numberAt<std::int16_t>(bytes);
    case PointField::kU16:
      return numberAt<std::uint16_t>(bytes);
    case PointField::kI32:
      return numberAt<std::int32_t>(bytes);
    case PointField::kU32:
      return numberAt<std::uint32_t>(bytes);
    case PointField::kF32:
      return numberAt<float>(bytes);
    default:
      return numberAt<double>(bytes);
  }
}

/// One field of every point of a message; drivers write the names in letters of either case.
class Column {
 public:
  Column(const PointCloud2& message, std::initializer_list<const char*> names) : m_(message) {
    for (const char* name : names) {
      for (const PointField& field : m_.point_fields) {
        if (field_ == nullptr && lowerCase(field.name) == lowerCase(name)) field_ = &field;
      }
    }
    if (field_ == nullptr) return;
    if (field_->datatype < PointField::kI8 || field_->datatype > PointField::kF64)
      throw std::runtime_error(
          fmt::format("field {} of type {}, expected 1 to 8", field_->name, field_->datatype));
    if (field_->offset > m_.point_step || m_.point_step - field_->offset < kSizes[field_->datatype])
      throw std::runtime_error(
          fmt::format("field {} at byte {} does not fit into points of {} bytes", field_->name,
                      field_->offset, m_.point_step));
  }
  explicit operator bool() const { return field_ != nullptr; }
  const PointField& field() const { return *field_; }
  /// use(value) for every point.
  template <class Use>
  void forEach(Use use) const {
    if (field_ == nullptr || m_.width == 0) return;
    for (std::size_t row = 0; row < m_.height; ++row) {
      const char* at = m_.data.data() + row * m_.row_step + field_->offset;
      for (std::size_t i = 0; i < m_.width; ++i, at += m_.point_step)
        use(valueAt(at, field_->datatype, m_.is_bigendian != 0));
    }
  }

 private:
  const PointCloud2& m_;
  const PointField* field_ = nullptr;
};

void check(const PointCloud2& m) {
  const std::uint64_t row = std::uint64_t{m.width} * m.point_step;
  if (m.height > 1 && m.row_step < row)
    throw std::runtime_error(fmt::format("rows of {} bytes for {} points of {} bytes", m.row_step,
                                         m.width, m.point_step));
  const std::uint64_t all =
      m.width == 0 || m.height == 0 ? 0 : std::uint64_t{m.height - 1} * m.row_step + row;
  if (m.data.size() < all || (all > 0 && m.point_step == 0))
    throw std::runtime_error(fmt::format("{} bytes of points, expected {} ({} x {} of {} bytes)",
                                         m.data.size(), all, m.height, m.width, m.point_step));
}

/// [s] of a time since 1970 in s, ms, us or ns, which lie a thousand apart: Hesai's drivers give s,
/// Livox's ns.
double secondsSince1970(double value) {
  constexpr double kMostSeconds = 1e11;
  for (const double unit : {1.0, 1e-3, 1e-6})
    if (std::abs(value) * unit < kMostSeconds) return value * unit;
  return value * 1e-9;
}

/// [s] of a value of the time field after the header's stamp, or the first return's without one.
double secondsOf(double value, const PointField& field, Stamp stamp, double first) {
  const std::string name = lowerCase(field.name);
  if (name == "t" || name == "offset_time") return value * 1e-9;
  if (name != "timestamp") return value;
  // Of a device that has no date: since the scan began, or since it was switched on.
  constexpr double kDated = 1e9;
  if (std::abs(secondsSince1970(first)) < kDated)
    return value - (std::abs(first) > kLongestScan ? first : 0);
  return secondsSince1970(value) - (stamp.ns > 0 ? stamp.seconds() : secondsSince1970(first));
}

constexpr std::initializer_list<const char*> kRates = {
    "doppler_velocity", "Doppler", "doppler", "range_rate", "radial_velocity",
    "radial_speed",     "v_r",     "vr",      "velocity"};

/// Its rate, if that is finite.
perception::RadarReturn withRate(perception::RadarReturn r, double rate, double scale) {
  r.has_rate = scale != 0 && std::isfinite(rate);
  r.range_rate = r.has_rate ? scale * rate : 0;
  return r;
}

void addPointFields(PointCloud2& m, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    m.point_fields.push_back({name, m.point_step, PointField::kF32, 1});
    m.point_step += sizeof(float);
  }
}

}  // namespace

Pose3 poseOf(const Pose& pose) {
  Pose3 T = Pose3::Identity();
  const Quaternion& o = pose.orientation;
  const Eigen::Quaterniond q(o.w, o.x, o.y, o.z);
  T.translation() = Vector3(pose.position[0], pose.position[1], pose.position[2]);
  constexpr double kTolerance = 0.01;
  if (!T.translation().allFinite() || !(std::abs(q.norm() - 1) < kTolerance))
    throw std::runtime_error("a pose that is not finite, or without a unit quaternion");
  T.linear() = q.normalized().toRotationMatrix();
  return T;
}

Pose messageOf(const Pose3& pose) {
  const Vector3& p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return {{p.x(), p.y(), p.z()}, {q.x(), q.y(), q.z(), q.w()}};
}

LidarCloud cloudOf(const PointCloud2& message, double intensity_max) {
  check(message);
  LidarCloud cloud;
  if (message.point_fields.empty() && message.data.empty()) return cloud;  // it names no fields
  std::vector<float>* to[] = {&cloud.x, &cloud.y, &cloud.z};
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const Column column(message, {names[i]});
    if (!column) throw std::runtime_error(fmt::format("points without a field {}", names[i]));
    if (column.field().datatype < PointField::kF32)
      throw std::runtime_error("x, y and z are whole numbers, whose unit is not said");
    column.forEach([&](double value) { to[i]->push_back(static_cast<float>(value)); });
  }
  if (const Column column(message,
                          {"intensity", "i", "reflectivity", "reflectance", "intensities"});
      column) {
    const double most = intensity_max > 0                            ? intensity_max
                        : column.field().datatype == PointField::kU8 ? 255.0
                                                                     : 1.0;
    column.forEach([&](double v) { cloud.intensity.push_back(static_cast<float>(v / most)); });
  }
  Column(message, {"ring", "channel", "line", "laser_id"}).forEach([&](double value) {
    cloud.ring.push_back(static_cast<std::uint16_t>(std::clamp(value, 0.0, 65535.0)));
  });
  if (const Column column(message, {"t", "offset_time", "time", "time_offset", "timestamp"});
      column) {
    std::vector<double> times;
    column.forEach([&](double t) { times.push_back(t); });
    const double first = earliestOf(times, cloud);
    for (const double t : times)
      cloud.time_offset.push_back(
          static_cast<float>(secondsOf(t, column.field(), message.header.stamp, first)));
  }
  return cloud;
}

PointCloud2 messageOf(const LidarCloud& cloud, const Header& header, std::string& data) {
  PointCloud2 m;
  m.header = header;
  m.width = static_cast<std::uint32_t>(cloud.size());
  addPointFields(m, {"x", "y", "z", "intensity"});
  if (!cloud.time_offset.empty()) addPointFields(m, {"time_offset"});
  if (!cloud.ring.empty()) {
    m.point_fields.push_back({"ring", m.point_step, PointField::kU16, 1});
    m.point_step += sizeof(std::uint16_t);
  }
  m.row_step = m.point_step * m.width;
  data.clear();
  data.reserve(m.row_step);
  const auto put = [&](const auto& value) {
    data.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    put(cloud.x[i]), put(cloud.y[i]), put(cloud.z[i]);
    put(cloud.intensity.empty() ? 0.0F : cloud.intensity[i]);
    if (!cloud.time_offset.empty()) put(cloud.time_offset[i]);
    if (!cloud.ring.empty()) put(cloud.ring[i]);
  }
  m.data = data;
  m.is_dense =
      std::all_of(cloud.x.begin(), cloud.x.end(), [](float v) { return std::isfinite(v); });
  return m;
}

RadarReturns returnsOf(const RadarScan& message, double rate_scale) {
  RadarReturns radar;
  for (const RadarReturn& given : message.returns) {
    perception::RadarReturn r;
    r.range = static_cast<double>(given.range), r.bearing = static_cast<double>(given.azimuth);
    r.elevation = static_cast<double>(given.elevation);
    r.amplitude = static_cast<double>(given.amplitude);
    radar.returns.push_back(withRate(r, static_cast<double>(given.doppler_velocity), rate_scale));
  }
  return radar;
}

bool isOfRadar(const PointCloud2& message) {
  return Column(message, kRates) && !Column(message, {"ring", "channel", "line"});
}

RadarReturns returnsOf(const PointCloud2& message, double rate_scale) {
  const LidarCloud places = cloudOf(message);
  RadarReturns radar;
  radar.returns.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto x = static_cast<double>(places.x[i]), y = static_cast<double>(places.y[i]),
               z = static_cast<double>(places.z[i]);
    perception::RadarReturn r;
    r.range = std::sqrt(x * x + y * y + z * z), r.bearing = std::atan2(y, x);
    r.elevation = std::atan2(z, std::hypot(x, y));
    r.has_rate = false;
    radar.returns.push_back(r);
  }
  std::size_t i = 0;
  Column(message, kRates).forEach([&](double rate) {
    radar.returns[i] = withRate(radar.returns[i], rate, rate_scale), ++i;
  });
  i = 0;
  Column(message, {"amplitude", "rcs", "RCS", "power", "snr", "intensity"})
      .forEach([&](double amplitude) { radar.returns[i++].amplitude = amplitude; });
  return radar;
}

RadarScan messageOf(const RadarReturns& radar, const Header& header) {
  RadarScan message{header, {}};
  for (const perception::RadarReturn& r : radar.returns) {
    message.returns.push_back(
        {static_cast<float>(r.range), static_cast<float>(r.bearing),
         static_cast<float>(r.elevation.value_or(0)),
         r.has_rate ? static_cast<float>(r.range_rate) : std::numeric_limits<float>::quiet_NaN(),
         static_cast<float>(r.amplitude)});
  }
  return message;
}

CameraInfo messageOf(const CameraModel& camera, const Header& header) {
  CameraInfo info;
  info.header = header;
  info.height = static_cast<std::uint32_t>(camera.height);
  info.width = static_cast<std::uint32_t>(camera.width);
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0};
  return info;
}

std::optional<CameraModel> cameraOf(const CameraInfo& m, bool rectified) {
  CameraModel camera;
  camera.width = static_cast<int>(m.width);
  camera.height = static_cast<int>(m.height);
  camera.fx = rectified ? m.P[0] : m.K[0];
  camera.cx = rectified ? m.P[2] : m.K[2];
  camera.fy = rectified ? m.P[5] : m.K[4];
  camera.cy = rectified ? m.P[6] : m.K[5];
  if (!(camera.fx > 0) || !(camera.fy > 0)) return {};
  return camera;
}

}  // namespace perception::ros
