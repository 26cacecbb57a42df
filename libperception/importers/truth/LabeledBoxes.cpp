#include "libperception/importers/truth/LabeledBoxes.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/truth/TruthTypes.h"

namespace perception {
namespace {

using BoxJson = nlohmann::json;

/// A value of a JSON file with its place in it.
class JsonPlace {
 public:
  JsonPlace(const std::string& path, const BoxJson& value, std::string place)
      : path_(path), value_(value), place_(std::move(place)) {}

  JsonPlace at(const char* key) const {
    if (!has(key)) fail(fmt::format("a member {}", key));
    return {path_, value_[key], place_ + "." + key};
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  std::vector<JsonPlace> items() const {
    if (!value_.is_array()) fail("a list");
    std::vector<JsonPlace> all;
    for (std::size_t i = 0; i < value_.size(); ++i)
      all.emplace_back(path_, value_[i], fmt::format("{}[{}]", place_, i));
    return all;
  }
  double real() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) fail("a finite number");
    return value_.get<double>();
  }
  std::string text() const {
    if (value_.is_number_integer()) return std::to_string(value_.get<std::int64_t>());
    if (!value_.is_string()) fail("a text");
    return value_.get<std::string>();
  }
  Vector3 xyz() const { return {at("x").real(), at("y").real(), at("z").real()}; }

 private:
  [[noreturn]] void fail(const std::string& expected) const {
    throw DataError(fmt::format("{}: {}: expected {}", path_, place_, expected));
  }
  const std::string& path_;
  const BoxJson& value_;
  std::string place_;
};

BoxJson parsedBoxes(const std::string& path) {
  try {
    return BoxJson::parse(readBytes(path));
  } catch (const BoxJson::exception& e) {
    throw DataError(fmt::format("{}: not JSON: {}", path, e.what()));
  }
}

/// `size`: length, width, height.
ObjectDetection::SpaceBox boxAbout(const Vector3& center, const Vector3& size, double yaw) {
  ObjectDetection::SpaceBox box;
  box.bottom_center = center - Vector3(0, 0, size.z() / 2);
  box.yaw = wrapAngle(yaw);
  box.length = size.x(), box.width = size.y(), box.height = size.z();
  return box;
}

}  // namespace

std::vector<std::vector<DataSetBox>> readCadcBoxes(const std::string& path) {
  const BoxJson json = parsedBoxes(path);
  std::vector<std::vector<DataSetBox>> frames;
  for (const JsonPlace& frame : JsonPlace(path, json, "frames").items()) {
    auto& boxes = frames.emplace_back();
    for (const JsonPlace& cuboid : frame.at("cuboids").items()) {
      const Vector3 size = cuboid.at("dimensions").xyz();
      boxes.push_back({cuboid.at("uuid").text(), truthTypeOf(cuboid.at("label").text()),
                       boxAbout(cuboid.at("position").xyz(), {size.y(), size.x(), size.z()},
                                cuboid.at("yaw").real())});
    }
  }
  return frames;
}

std::vector<DataSetBox> readBoreasBoxes(const std::string& path) {
  std::vector<DataSetBox> boxes;
  forEachRow(path, kCommas, [&](const TextRow& row) {
    row.expect(row.size() >= 9, "9: uuid type length width height x y z yaw");
    boxes.push_back({row.text(0), truthTypeOf(row.text(1)),
                     boxAbout({row.real(5), row.real(6), row.real(7)},
                              {row.real(2), row.real(3), row.real(4)}, row.real(8))});
  });
  return boxes;
}

std::vector<DataSetBox> readSprayBoxes(const std::string& path) {
  const BoxJson json = parsedBoxes(path);
  std::vector<DataSetBox> boxes;
  for (const JsonPlace& list : JsonPlace(path, json, "lists").items()) {
    for (const JsonPlace& instance : list.at("instances").items()) {
      const JsonPlace contour = instance.at("contour");
      const std::string id =
          instance.has("id") ? instance.at("id").text() : std::to_string(boxes.size());
      const std::string type =
          instance.has("class") ? truthTypeOf(instance.at("class").text()) : "Car";
      boxes.push_back({id, type,
                       boxAbout(contour.at("center3D").xyz(), contour.at("size3D").xyz(),
                                radians(contour.at("rotation3D").at("z").real()))});
    }
  }
  return boxes;
}

void BoxTruth::add(const std::vector<DataSetBox>& boxes, std::int64_t frame, Stamp stamp,
                   const Pose3& T_world_lidar, const LidarCloud& cloud) {
  for (const DataSetBox& labeled : boxes) {
    const auto next = static_cast<std::int64_t>(numbers_.size());
    TruthObject object;
    object.frame = frame;
    object.id = numbers_.emplace(labeled.id, next).first->second;
    object.type = labeled.type;
    object.ignore = !coveredType(labeled.type);
    placeTruth(labeled.box, T_world_lidar, object);
    object.lidar_points = returnsInside(labeled.box, cloud);
    log_.truth(stamp, std::move(object));
  }
}

}  // namespace perception
