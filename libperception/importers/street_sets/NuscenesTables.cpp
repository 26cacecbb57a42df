#include "libperception/importers/street_sets/NuscenesTables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportLog.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/truth/TruthTypes.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A row of a table; errors name file, row and member.
class NuscenesRow {
 public:
  NuscenesRow(const std::string& path, std::size_t number, const Json& row)
      : path_(path), number_(number), row_(row) {}

  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "a text");
    return at(key).get<std::string>();
  }
  std::int64_t whole(const char* key) const {
    if (!at(key).is_number_integer()) fail(key, "a whole number");
    return at(key).get<std::int64_t>();
  }
  bool flag(const char* key) const {
    if (!at(key).is_boolean()) fail(key, "true or false");
    return at(key).get<bool>();
  }
  const Json& at(const char* key) const {
    if (!row_.contains(key)) fail(key, "to be there");
    return row_[key];
  }
  /// The member's numbers, of a list or of a list of lists.
  std::vector<double> numbers(const char* key, std::size_t count) const {
    std::vector<double> values;
    collect(key, at(key), values);
    if (values.size() != count) fail(key, fmt::format("{} numbers", count));
    return values;
  }
  Pose3 pose() const {
    const auto t = numbers("translation", 3), r = numbers("rotation", 4);
    const auto pose = poseFrom({t[0], t[1], t[2]}, {r[0], r[1], r[2], r[3]});
    if (!pose) fail("rotation", "a unit quaternion w, x, y, z");
    return *pose;
  }
  [[noreturn]] void fail(const char* key, const std::string& expected) const {
    throw DataError(fmt::format("{}: row {}: {}: expected {}", path_, number_, key, expected));
  }

 private:
  void collect(const char* key, const Json& value, std::vector<double>& values) const {
    if (value.is_array()) {
      for (const Json& part : value) collect(key, part, values);
    } else if (value.is_number() && std::isfinite(value.get<double>())) {
      values.push_back(value.get<double>());
    } else {
      fail(key, "finite numbers");
    }
  }
  const std::string& path_;
  std::size_t number_;
  const Json& row_;
};

/// Calls use(row) for each row of ROOT/VERSION/NAME.json, which is not kept.
void forEachTableRow(const std::string& tables, const char* name,
                     const std::function<void(const NuscenesRow&)>& use) {
  const std::string path = (fs::path(tables) / (std::string(name) + ".json")).string();
  std::ifstream in(path);
  if (!in) throw DataError(path + ": no such file", ExitCode::kNoInput);
  std::size_t number = 0;
  const auto take = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth != 1 || event != Json::parse_event_t::object_end) return true;
    use(NuscenesRow(path, ++number, parsed));
    return false;
  };
  try {
    if (!Json::parse(in, take).is_array()) throw DataError(path + ": expected a list of rows");
  } catch (const Json::exception& e) {
    throw DataError(fmt::format("{}: behind row {}: not JSON: {}", path, number, e.what()));
  }
}

/// Names of all rows of a small table by their token.
std::map<std::string, std::string> namesOf(const std::string& tables, const char* table,
                                           const char* key) {
  std::map<std::string, std::string> names;
  forEachTableRow(tables, table,
                  [&](const NuscenesRow& row) { names[row.text("token")] = row.text(key); });
  return names;
}

Stamp stampOfMicroseconds(std::int64_t us) { return {us * 1000}; }

/// Reads one scene; the tables refer to each other by tokens.
class NuscenesReader {
 public:
  NuscenesReader(const std::string& tables, const NuscenesScene& scene)
      : tables_(tables), scene_(scene) {}

  NuscenesDrive read() {
    readSamples();
    readData();
    readSensors();
    readPoses();
    readBoxes();
    std::stable_sort(
        drive_.data.begin(), drive_.data.end(),
        [](const NuscenesData& a, const NuscenesData& b) { return a.stamp < b.stamp; });
    return std::move(drive_);
  }

 private:
  void readSamples() {
    std::vector<std::pair<std::int64_t, std::string>> samples;
    forEachTableRow(tables_, "sample", [&](const NuscenesRow& row) {
      if (row.text("scene_token") == scene_.token)
        samples.emplace_back(row.whole("timestamp"), row.text("token"));
    });
    std::sort(samples.begin(), samples.end());
    for (const auto& [time, token] : samples) {
      samples_[token] = static_cast<std::int64_t>(drive_.samples.size());
      drive_.samples.push_back(stampOfMicroseconds(time));
      drive_.sample_tokens.push_back(token);
    }
    if (samples.empty())
      throw DataError(fmt::format("{}: sample.json has none of scene {}", tables_, scene_.name));
  }
  void readData() {
    forEachTableRow(tables_, "sample_data", [&](const NuscenesRow& row) {
      const auto sample = samples_.find(row.text("sample_token"));
      if (sample == samples_.end()) return;
      NuscenesData data;
      data.stamp = stampOfMicroseconds(row.whole("timestamp"));
      data.sample = sample->second;
      data.key = row.flag("is_key_frame");
      data.file = row.text("filename");
      calibrations_.push_back(row.text("calibrated_sensor_token"));
      poses_.push_back(row.text("ego_pose_token"));
      drive_.data.push_back(std::move(data));
    });
  }
  void readSensors() {
    const auto channels = namesOf(tables_, "sensor", "channel");
    const auto modalities = namesOf(tables_, "sensor", "modality");
    const std::set<std::string> wanted(calibrations_.begin(), calibrations_.end());
    std::map<std::string, std::size_t> numbers;
    forEachTableRow(tables_, "calibrated_sensor", [&](const NuscenesRow& row) {
      if (wanted.count(row.text("token")) == 0) return;
      const auto channel = channels.find(row.text("sensor_token"));
      if (channel == channels.end()) row.fail("sensor_token", "a token of sensor.json");
      NuscenesSensor sensor;
      sensor.channel = channel->second, sensor.modality = modalities.at(channel->first);
      sensor.T_ego_sensor = row.pose();
      if (sensor.modality == "camera") {
        const auto k = row.numbers("camera_intrinsic", 9);
        sensor.fx = k[0], sensor.cx = k[2], sensor.fy = k[4], sensor.cy = k[5];
      }
      numbers[row.text("token")] = drive_.sensors.size();
      drive_.sensors.push_back(std::move(sensor));
    });
    for (std::size_t i = 0; i < drive_.data.size(); ++i) {
      const auto found = numbers.find(calibrations_[i]);
      if (found == numbers.end()) failToken("calibrated_sensor", calibrations_[i]);
      drive_.data[i].sensor = found->second;
    }
  }
  void readPoses() {
    std::map<std::string, std::vector<std::size_t>> wanted;
    for (std::size_t i = 0; i < poses_.size(); ++i) wanted[poses_[i]].push_back(i);
    forEachTableRow(tables_, "ego_pose", [&](const NuscenesRow& row) {
      const auto found = wanted.find(row.text("token"));
      if (found == wanted.end()) return;
      for (const std::size_t i : found->second) drive_.data[i].T_global_ego = row.pose();
      wanted.erase(found);
    });
    if (!wanted.empty()) failToken("ego_pose", wanted.begin()->first);
  }
  void readBoxes() {
    const auto categories = namesOf(tables_, "category", "name");
    const auto instances = namesOf(tables_, "instance", "category_token");
    const auto attributes = namesOf(tables_, "attribute", "name");
    std::map<std::string, std::int64_t> ids;
    forEachTableRow(tables_, "sample_annotation", [&](const NuscenesRow& row) {
      const auto sample = samples_.find(row.text("sample_token"));
      if (sample == samples_.end()) return;
      const std::string instance = row.text("instance_token");
      const auto category = instances.find(instance);
      if (category == instances.end()) row.fail("instance_token", "a token of instance.json");
      const auto name = categories.find(category->second);
      if (name == categories.end()) row.fail("instance_token", "one with a category");
      std::vector<std::string> named;
      for (const Json& token : row.at("attribute_tokens"))
        if (const auto found = attributes.find(token.get<std::string>()); found != attributes.end())
          named.push_back(found->second);
      NuscenesBox box = boxOf(row, nuscenesTypeOf(name->second, named));
      box.sample = sample->second;
      box.object.id = ids.emplace(instance, static_cast<std::int64_t>(ids.size())).first->second;
      drive_.boxes.push_back(std::move(box));
    });
  }
  static NuscenesBox boxOf(const NuscenesRow& row, std::string type) {
    const auto size = row.numbers("size", 3);
    const Pose3 pose = row.pose();
    NuscenesBox box;
    TruthObject& o = box.object;
    o.width = size[0], o.length = size[1], o.height = size[2];
    if (!(std::min({size[0], size[1], size[2]}) > 0)) row.fail("size", "numbers above 0");
    o.position = pose.translation() - Vector3(0, 0, o.height / 2);
    o.yaw = std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
    o.type = std::move(type);
    const std::int64_t lidar = row.whole("num_lidar_pts"), radar = row.whole("num_radar_pts");
    o.lidar_points = static_cast<int>(std::clamp<std::int64_t>(lidar, 0, 1'000'000));
    o.ignore = !coveredType(o.type) || lidar + radar <= 0;
    return box;
  }
  [[noreturn]] void failToken(const char* table, const std::string& token) const {
    throw DataError(fmt::format("{}: {}.json has no row {}, to which sample_data.json refers",
                                tables_, table, token));
  }

  const std::string& tables_;
  const NuscenesScene& scene_;
  NuscenesDrive drive_;
  std::map<std::string, std::int64_t> samples_;    ///< number of a key frame by its token
  std::vector<std::string> calibrations_, poses_;  ///< tokens, one a row of the drive's data
};

}  // namespace

std::vector<NuscenesScene> readNuscenesScenes(const std::string& tables) {
  std::vector<NuscenesScene> scenes;
  forEachTableRow(tables, "scene", [&](const NuscenesRow& row) {
    scenes.push_back(
        {row.text("token"), row.text("name"), row.text("description"), row.whole("nbr_samples")});
  });
  return scenes;
}

NuscenesDrive readNuscenesDrive(const std::string& tables, const NuscenesScene& scene) {
  return NuscenesReader(tables, scene).read();
}

std::string nuscenesTypeOf(const std::string& category,
                           const std::vector<std::string>& attributes) {
  const auto begins = [&](const char* prefix) { return category.rfind(prefix, 0) == 0; };
  const bool ridden =
      std::find(attributes.begin(), attributes.end(), "cycle.with_rider") != attributes.end();
  for (const char* no_walker : {"stroller", "wheelchair", "personal_mobility"})
    if (category == std::string("human.pedestrian.") + no_walker) return truthTypeOf(no_walker);
  if (begins("human.pedestrian")) return "Pedestrian";
  if (begins("vehicle.bus")) return "Bus";
  if (category == "vehicle.car" || category == "vehicle.emergency.police") return "Car";
  if (category == "vehicle.bicycle") return ridden ? "Cyclist" : "Bicycle";
  if (category == "vehicle.motorcycle") return ridden ? "Motorcyclist" : "Motorcycle";
  return truthTypeOf(category.substr(category.rfind('.') + 1));
}

}  // namespace perception
