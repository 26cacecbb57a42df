#include "libperception/interop/exports/FoxgloveMessages.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "libperception/interop/exports/Jpeg.h"

namespace perception {
namespace {

using nlohmann::json;

constexpr int kFloat32 = 7;                            // foxglove.PackedElementField
constexpr int kDeleteAll = 1;                          // foxglove.SceneEntityDeletion
constexpr int kInfoLevel = 2, kWarningLevel = 3;       // foxglove.Log
constexpr double kTextHeight = 0.5, kTextAbove = 0.4;  // [m]

std::string base64(std::string_view data) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(data.data());
  const std::size_t size = data.size();
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    std::uint32_t bits = static_cast<std::uint32_t>(bytes[i]) << 16;
    if (i + 1 < size) bits |= static_cast<std::uint32_t>(bytes[i + 1]) << 8;
    if (i + 2 < size) bits |= bytes[i + 2];
    text += kDigits[bits >> 18 & 63];
    text += kDigits[bits >> 12 & 63];
    text += i + 1 < size ? kDigits[bits >> 6 & 63] : '=';
    text += i + 2 < size ? kDigits[bits & 63] : '=';
  }
  return text;
}

json time(Stamp stamp) { return {{"sec", stamp.ns / 1000000000}, {"nsec", stamp.ns % 1000000000}}; }

json vector(const Vector3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

json quaternion(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

json color(double r, double g, double b, double a) {
  return {{"r", r}, {"g", g}, {"b", b}, {"a", a}};
}

json pose(const Vector3& position, double yaw) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(yaw, Vector3::UnitZ()));
  return {{"position", vector(position)}, {"orientation", quaternion(q)}};
}

json entity(const SceneObject& object, const std::string& name, Stamp stamp) {
  const Vector3 center = object.position + Vector3(0, 0, object.height / 2);
  const Vector3 above = object.position + Vector3(0, 0, object.height + kTextAbove);
  const Vector3 size(object.length, object.width, object.height);
  const std::string id = std::to_string(object.id);
  const std::string mark = object.classified ? "" : "?";
  const auto pair = [](const char* key, std::string value) {
    return json{{"key", key}, {"value", std::move(value)}};
  };
  json result = {{"timestamp", time(stamp)},
                 {"frame_id", "world"},
                 {"id", id},
                 {"lifetime", {{"sec", 0}, {"nsec", 0}}},
                 {"frame_locked", false},
                 {"metadata",
                  {pair("class", name), pair("classified", object.classified ? "1" : "0"),
                   pair("id", id), pair("speed", fmt::format("{:.2f}", object.speed)),
                   pair("existence", fmt::format("{:.4f}", object.existence)),
                   pair("p_front", fmt::format("{:.4f}", object.p_front))}},
                 {"cubes",
                  {{{"pose", pose(center, object.yaw)},
                    {"size", vector(size)},
                    {"color", color(0.2, 0.6, 1, object.classified ? 0.6 : 0.3)}}}},
                 {"texts",
                  {{{"pose", pose(above, 0)},
                    {"billboard", true},
                    {"font_size", kTextHeight},
                    {"scale_invariant", false},
                    {"color", color(1, 1, 1, 1)},
                    {"text", fmt::format("{}{} {} {:.1f} m/s", name, mark, id, object.speed)}}}}};
  for (const char* none : {"arrows", "spheres", "cylinders", "lines", "triangles", "models"}) {
    result[none] = json::array();
  }
  return result;
}

}  // namespace

std::string sceneUpdate(const Scene& scene, const std::vector<std::string>& class_names,
                        std::set<std::uint64_t>& shown) {
  json entities = json::array(), deletions = json::array();
  std::set<std::uint64_t> now;
  for (const SceneObject& object : scene.objects) {
    entities.push_back(entity(object, class_names.at(object.class_id), scene.stamp));
    now.insert(object.id);
  }
  for (const std::uint64_t id : shown) {
    if (now.count(id) != 0) continue;
    deletions.push_back(
        {{"timestamp", time(scene.stamp)}, {"type", 0}, {"id", std::to_string(id)}});
  }
  shown = std::move(now);
  return json{{"deletions", deletions}, {"entities", entities}}.dump();
}

std::string wholeSceneUpdate(const Scene& scene, const std::vector<std::string>& class_names) {
  json entities = json::array();
  for (const SceneObject& object : scene.objects)
    entities.push_back(entity(object, class_names.at(object.class_id), scene.stamp));
  const json all = {{"timestamp", time(scene.stamp)}, {"type", kDeleteAll}, {"id", ""}};
  return json{{"deletions", json::array({all})}, {"entities", entities}}.dump();
}

std::string logMessage(Stamp stamp, bool warning, const std::string& name,
                       const std::string& message) {
  return json{{"timestamp", time(stamp)},
              {"level", warning ? kWarningLevel : kInfoLevel},
              {"message", message},
              {"name", name},
              {"file", ""},
              {"line", 0}}
      .dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string numbersMessage(Stamp stamp, const std::map<std::string, double>& values) {
  json out = {{"timestamp", time(stamp)}};
  for (const auto& [name, value] : values)
    if (std::isfinite(value)) out[name] = value;
  return out.dump();
}

namespace {

/// foxglove.PointCloud of the values of all points, one after the other.
std::string pointsMessage(std::initializer_list<const char*> names,
                          const std::vector<float>& values, Stamp stamp,
                          const std::string& frame_id) {
  std::string data(values.size() * sizeof(float), '\0');
  if (!values.empty()) std::memcpy(data.data(), values.data(), data.size());
  json fields = json::array();
  for (const char* name : names) {
    fields.push_back(
        {{"name", name}, {"offset", fields.size() * sizeof(float)}, {"type", kFloat32}});
  }
  return json{{"timestamp", time(stamp)},
              {"frame_id", frame_id},
              {"pose", pose(Vector3::Zero(), 0)},
              {"point_stride", names.size() * sizeof(float)},
              {"fields", fields},
              {"data", base64(data)}}
      .dump();
}

}  // namespace

std::string pointCloud(const LidarCloud& cloud, Stamp stamp, const std::string& frame_id) {
  std::vector<float> values;
  values.reserve(4 * cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float intensity = cloud.intensity.empty() ? 0.0F : cloud.intensity[i];
    values.insert(values.end(), {cloud.x[i], cloud.y[i], cloud.z[i], intensity});
  }
  return pointsMessage({"x", "y", "z", "intensity"}, values, stamp, frame_id);
}

std::string pointCloud(const RadarReturns& radar, Stamp stamp, const std::string& frame_id) {
  std::vector<float> values;
  for (const RadarReturn& r : radar.returns) {
    const double up = r.elevation.value_or(0), level = r.range * std::cos(up);
    const double rate = r.has_rate ? r.range_rate : std::numeric_limits<double>::quiet_NaN();
    for (const double v : {level * std::cos(r.bearing), level * std::sin(r.bearing),
                           r.range * std::sin(up), rate, r.amplitude})
      values.push_back(static_cast<float>(v));
  }
  return pointsMessage({"x", "y", "z", "range_rate", "amplitude"}, values, stamp, frame_id);
}

std::string frameTransform(const Pose3& T, Stamp stamp, const std::string& parent,
                           const std::string& child) {
  return json{{"timestamp", time(stamp)},
              {"parent_frame_id", parent},
              {"child_frame_id", child},
              {"translation", vector(T.translation())},
              {"rotation", quaternion(Eigen::Quaterniond(T.linear()))}}
      .dump();
}

std::string compressedImage(const Raster& raster, Stamp stamp, const std::string& frame_id) {
  const std::string bytes = jpegOf(raster);
  return json{{"timestamp", time(stamp)},
              {"frame_id", frame_id},
              {"data", base64(bytes)},
              {"format", "jpeg"}}
      .dump();
}

}  // namespace perception
