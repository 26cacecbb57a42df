#include "libperception/importers/street_sets/AimotiveFiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/PoseSteps.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/truth/TruthTypes.h"

namespace perception {

namespace {

/// [s] A label holds so long before and behind its instant.
constexpr double kLabelReach = 0.1;

/// `count` numbers of json[key]; what[key] names it in messages.
std::vector<double> numbersOf(const std::string& path, const nlohmann::json& json,
                              const std::string& what, const char* key, std::size_t count) {
  std::vector<double> values;
  const auto fail = [&] {
    throw DataError(fmt::format("{}: {}: no {} of {} numbers", path, what, key, count));
  };
  if (!json.is_object() || !json.contains(key)) fail();
  const auto add = [&](const nlohmann::json& value) {
    if (!value.is_number()) fail();
    values.push_back(value.get<double>());
  };
  for (const auto& row : json[key]) {
    if (!row.is_array()) {
      add(row);
      continue;
    }
    for (const auto& value : row) add(value);
  }
  if (values.size() != count) fail();
  return values;
}

Pose3 poseOf(const std::string& path, const nlohmann::json& json, const std::string& sensor) {
  const auto values =
      numbersOf(path, json.value(sensor, nlohmann::json()), sensor, "RT_body_from_sensor", 16);
  Pose3 pose = Pose3::Identity();
  for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = values[static_cast<std::size_t>(i)];
  const Eigen::Matrix3d r = pose.linear();
  if (!(r * r.transpose()).isIdentity(1e-3) || r.determinant() < 0)
    throw DataError(fmt::format("{}: {}: RT_body_from_sensor is no rigid motion", path, sensor));
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  return pose;
}

/// A table whose rows go forward in time.
class TimedTable {
 public:
  explicit TimedTable(const std::string& path, const char* time = "t")
      : csv(CsvTable::fromFile(path)), time_(csv.column(time)) {
    for (std::size_t i = 1; i < csv.rows(); ++i) {
      if (t(i) < t(i - 1)) csv.fault(i, time_, "a time not before that of the line above");
    }
    if (csv.rows() == 0) throw DataError(path + ": no row in it");
  }
  double t(std::size_t row) const { return csv.real(row, time_); }
  double at(std::size_t row, const char* column) const { return csv.real(row, csv.column(column)); }
  double positive(std::size_t row, const char* column) const {
    if (!(at(row, column) > 0)) csv.fault(row, csv.column(column), "a number above 0");
    return at(row, column);
  }
  std::int64_t number(std::size_t row, const char* column) const {
    const std::int64_t value = csv.integer(row, csv.column(column));
    if (value < 0) csv.fault(row, csv.column(column), "a number of at least 0");
    return value;
  }

  CsvTable csv;

 private:
  CsvTable::Column time_;
};

AimotiveBox boxOf(const TimedTable& table, std::size_t i) {
  AimotiveBox b;
  b.t = table.t(i);
  const auto type = table.csv.column("type");
  if (table.csv.text(i, type).empty()) table.csv.fault(i, type, "a type such as CAR");
  b.type = truthTypeOf(std::string(table.csv.text(i, type)));
  b.box.length = table.positive(i, "length");
  b.box.width = table.positive(i, "width");
  b.box.height = table.positive(i, "height");
  b.box.bottom_center =
      Vector3(table.at(i, "x"), table.at(i, "y"), table.at(i, "z") - b.box.height / 2);
  b.box.yaw = wrapAngle(table.at(i, "yaw"));
  b.relative_velocity = Vector2(table.at(i, "vx_rel"), table.at(i, "vy_rel"));
  b.occluded = static_cast<int>(table.number(i, "occluded"));
  b.truncated = std::clamp(table.at(i, "truncated"), 0.0, 1.0);
  return b;
}

AimotiveBox movedOn(AimotiveBox box, double t) {
  box.box.bottom_center.head<2>() += (t - box.t) * box.relative_velocity;
  box.t = t;
  return box;
}

AimotiveEgo::State movedOn(AimotiveEgo::State state, double t) {
  const double dt = t - state.t, turn = state.yaw_rate * dt;
  const Vector2 step = dt * rotate2(turn / 2, state.velocity);
  state.T_world_body = state.T_world_body * makePose(step.x(), step.y(), 0, turn);
  state.t = t;
  return state;
}

}  // namespace

AimotiveCalibration readAimotiveCalibration(const std::string& path) {
  const auto json = nlohmann::json::parse(readBytes(path), nullptr, false);
  if (!json.is_object()) throw DataError(path + ": no JSON object, expected a calibration");
  AimotiveCalibration out;
  out.T_body_lidar = poseOf(path, json, "M_LIDAR_M");
  out.T_body_radar_front = poseOf(path, json, "F_LRR_C");
  out.T_body_radar_rear = poseOf(path, json, "B_LRR_C");
  const std::string name = "F_MIDLONGRANGECAM_CL";
  out.T_body_camera = poseOf(path, json, name);
  const auto numbers = [&](const char* key, std::size_t count) {
    return numbersOf(path, json[name], name, key, count);
  };
  const auto focal = numbers("focal_length_px", 2), center = numbers("principal_point_px", 2);
  const auto size = numbers("image_resolution_px", 2);
  if (!(focal[0] > 0) || !(focal[1] > 0))
    throw DataError(fmt::format("{}: {}: focal_length_px is not above 0", path, name));
  out.camera.fx = focal[0];
  out.camera.fy = focal[1];
  out.camera.cx = center[0];
  out.camera.cy = center[1];
  out.camera.width = static_cast<int>(size[0]);
  out.camera.height = static_cast<int>(size[1]);
  out.distortion = numbers("distortion_coeffs", 5);
  return out;
}

std::vector<AimotiveTurn> readAimotiveTurns(const std::string& path) {
  const TimedTable table(path, "t_start");
  std::vector<AimotiveTurn> turns;
  for (std::size_t i = 0; i < table.csv.rows(); ++i) {
    AimotiveTurn turn;
    turn.number = table.number(i, "scan");
    turn.start = table.t(i);
    turn.end = table.at(i, "t_end");
    if (!(turn.end > turn.start))
      table.csv.fault(i, table.csv.column("t_end"), "a time after t_start");
    turn.points = table.csv.natural(i, table.csv.column("points"));
    turns.push_back(turn);
  }
  return turns;
}

AimotiveEgo::AimotiveEgo(const std::string& path) {
  const TimedTable table(path);
  for (std::size_t i = 0; i < table.csv.rows(); ++i) {
    State state;
    state.t = table.t(i);
    state.velocity = Vector2(table.at(i, "vx"), table.at(i, "vy"));
    state.yaw_rate = table.at(i, "yaw_rate");
    if (!states_.empty()) {  // trapezoids: the motion between two rows is their mean
      State between = states_.back();
      between.velocity = (between.velocity + state.velocity) / 2;
      between.yaw_rate = (between.yaw_rate + state.yaw_rate) / 2;
      state.T_world_body = movedOn(between, state.t).T_world_body;
    }
    states_.push_back(state);
  }
}

AimotiveEgo::State AimotiveEgo::at(double t) const {
  const auto after = std::lower_bound(states_.begin(), states_.end(), t,
                                      [](const State& s, double time) { return s.t < time; });
  if (after == states_.end()) return movedOn(states_.back(), t);
  if (after == states_.begin()) return movedOn(states_.front(), t);
  const State& before = *std::prev(after);
  const double share = (t - before.t) / (after->t - before.t);
  State state;
  state.t = t;
  state.velocity = (1 - share) * before.velocity + share * after->velocity;
  state.yaw_rate = (1 - share) * before.yaw_rate + share * after->yaw_rate;
  state.T_world_body = interpolate(before.T_world_body, after->T_world_body, share);
  return state;
}

std::map<std::int64_t, std::vector<AimotiveBox>> readAimotiveBoxes(const std::string& path) {
  const TimedTable table(path);
  std::map<std::int64_t, std::vector<AimotiveBox>> objects;
  for (std::size_t i = 0; i < table.csv.rows(); ++i) {
    auto& rows = objects[table.number(i, "id")];
    AimotiveBox box = boxOf(table, i);
    if (!rows.empty() && !(box.t > rows.back().t))
      table.csv.fault(i, table.csv.column("t"), "one box of an object at a time");
    rows.push_back(std::move(box));
  }
  return objects;
}

std::optional<AimotiveBox> boxAt(const std::vector<AimotiveBox>& rows, double t) {
  const auto after = std::lower_bound(rows.begin(), rows.end(), t,
                                      [](const AimotiveBox& b, double time) { return b.t < time; });
  const bool has_after = after != rows.end() && after->t - t <= kLabelReach;
  const bool has_before = after != rows.begin() && t - std::prev(after)->t <= kLabelReach;
  if (!has_after && !has_before) return {};
  if (!has_before) return movedOn(*after, t);
  if (!has_after) return movedOn(*std::prev(after), t);
  const AimotiveBox& before = *std::prev(after);
  const double share = (t - before.t) / (after->t - before.t);
  AimotiveBox out = before;
  out.t = t;
  out.box.bottom_center = (1 - share) * before.box.bottom_center + share * after->box.bottom_center;
  out.box.yaw = wrapAngle(before.box.yaw + share * wrapAngle(after->box.yaw - before.box.yaw));
  out.relative_velocity = (1 - share) * before.relative_velocity + share * after->relative_velocity;
  return out;
}

std::vector<AimotiveRadarScan> readAimotiveRadar(const std::string& path) {
  const TimedTable table(path);
  std::vector<AimotiveRadarScan> scans;
  for (std::size_t i = 0; i < table.csv.rows(); ++i) {
    const std::int64_t frame = table.number(i, "frame");
    if (scans.empty() || scans.back().frame != frame) scans.push_back({frame, table.t(i), {}});
    RadarReturn& r = scans.back().returns.returns.emplace_back();
    r.range = table.positive(i, "range");
    r.bearing = wrapAngle(table.at(i, "azimuth"));
    r.elevation = table.at(i, "elevation");
    r.range_rate = table.at(i, "range_rate");
    r.amplitude = table.at(i, "rcs");
  }
  return scans;
}

std::vector<AimotiveFrame> readAimotiveFrames(const std::string& path) {
  const TimedTable table(path);
  std::vector<AimotiveFrame> frames;
  for (std::size_t i = 0; i < table.csv.rows(); ++i)
    frames.push_back({table.number(i, "frame"), table.t(i)});
  return frames;
}

}  // namespace perception
