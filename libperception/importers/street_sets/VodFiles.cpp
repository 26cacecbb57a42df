#include "libperception/importers/street_sets/VodFiles.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"

namespace perception {

std::vector<VodRadarPoint> readVodRadar(const std::string& path) {
  const std::string bytes = readBytes(path);
  if (bytes.size() % sizeof(VodRadarPoint) != 0) {
    throw DataError(fmt::format(
        "{}: {} bytes, expected 28 a point (float32 x, y, z, RCS, v_r, v_r_compensated, time)",
        path, bytes.size()));
  }
  std::vector<VodRadarPoint> points(bytes.size() / sizeof(VodRadarPoint));
  if (!points.empty()) std::memcpy(points.data(), bytes.data(), bytes.size());
  return points;
}

RadarReturns returnsOf(const std::vector<VodRadarPoint>& points, bool still) {
  RadarReturns out;
  for (const VodRadarPoint& p : points) {
    const double flat = std::hypot(p.x, p.y);
    RadarReturn& r = out.returns.emplace_back();
    r.range = std::hypot(flat, static_cast<double>(p.z));
    r.bearing = std::atan2(p.y, p.x);
    r.elevation = std::atan2(static_cast<double>(p.z), flat);
    r.range_rate = still ? p.rate_compensated : p.rate;
    r.amplitude = p.rcs;
  }
  return out;
}

Vector2 ownVelocity(const std::vector<VodRadarPoint>& points) {
  Matrix2 a = Matrix2::Zero();
  Vector2 b = Vector2::Zero();
  for (const VodRadarPoint& p : points) {
    const double range = std::hypot(std::hypot(p.x, p.y), static_cast<double>(p.z));
    if (!(range > 0) || !std::isfinite(range + p.rate + p.rate_compensated)) continue;
    const Vector2 u(p.x / range, p.y / range);
    a += u * u.transpose();
    b -= u * static_cast<double>(p.rate - p.rate_compensated);
  }
  if (!(a.determinant() > 1e-6)) return Vector2::Zero();
  return a.inverse() * b;
}

Pose3 readVodPose(const std::string& path) {
  Pose3 pose = Pose3::Identity();
  bool found = false;
  std::size_t line = 0;
  const std::string bytes = readBytes(path);
  for (std::size_t begin = 0; begin < bytes.size() && !found; ++line) {
    const std::size_t end = std::min(bytes.find('\n', begin), bytes.size());
    const auto json =
        nlohmann::json::parse(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                              bytes.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
    begin = end + 1;
    if (!json.is_object() || !json.contains("odomToCamera")) continue;
    const auto& values = json["odomToCamera"];
    if (!values.is_array() || values.size() != 16) break;
    std::string text;
    for (std::size_t i = 0; i < 12; ++i)
      text += (values[i].is_number() ? values[i].dump() : "?") + " ";
    pose = TextRow(path, line + 1, text, kSpaces).pose34(0);
    found = true;
  }
  if (!found) throw DataError(path + ": no odomToCamera of 16 numbers, expected a VoD pose");
  return pose;
}

}  // namespace perception
