#include "libperception/radar/RadarFrontEnd.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kSteepest = radians(60);  // larger elevations are no road users
constexpr double kDoubleSigmas = 3;        // deviations within which range and rate are doubled

constexpr double kBorderSigmas = 3;  // deviations of a bearing beyond the border of the view

DetectionParams radarDefaults() {
  DetectionParams p;
  p.kind = "radar";
  p.modality = Modality::kRadar;
  p.clutter_per_scan = 0.3;  // method.md 5.3
  p.births_per_scan = 0.01;
  p.range_min = 1;
  p.range_max = 120;
  p.fov = radians(60);
  p.detection_exponent = 0.3;  // fluctuates (Swerling 1): less correlated between scans than lidar
                               // detections; tuned on scenario A (simulated)
  return p;
}

/// A return on the ground plane, in the level frame.
struct FlatReturn {
  double range, bearing, rate, amplitude;
  bool has_rate;
  int index;
};

std::vector<FlatReturn> flatten(const RadarReturns& data, const Pose3& T_level_sensor,
                                const RadarParams& params, std::size_t& dropped) {
  std::vector<FlatReturn> out;
  for (std::size_t i = 0; i < data.returns.size(); ++i) {
    const RadarReturn& r = data.returns[i];
    const double flip = params.upside_down ? -1 : 1;
    const double bearing = flip * r.bearing, elevation = flip * r.elevation.value_or(0);
    const bool has_rate = r.has_rate && std::isfinite(r.range_rate);
    const Vector3 d = T_level_sensor.linear() * Vector3(std::cos(elevation) * std::cos(bearing),
                                                        std::cos(elevation) * std::sin(bearing),
                                                        std::sin(elevation));
    const double flat = d.head<2>().norm();
    const bool usable = std::isfinite(r.range + bearing + elevation) && r.range > 0 &&
                        (data.max_range <= 0 || r.range <= data.max_range) &&
                        flat >= std::cos(kSteepest) && (has_rate || !r.has_rate);
    if (!usable) {
      ++dropped;
      continue;
    }
    // Range and range rate on the ground: objects move horizontally, so the rate along an inclined
    // line of sight is smaller by its cosine.
    out.push_back({r.range * flat, std::atan2(d.y(), d.x()), has_rate ? r.range_rate / flat : 0,
                   std::isfinite(r.amplitude) ? r.amplitude : 0, has_rate, static_cast<int>(i)});
  }
  return out;
}

/// Whether `r` is the double bounce of `first` (object - vehicle - object): twice the range and
/// range rate, not stronger. Only where the rate is measured, which distinguishes it from another
/// object.
bool isDoubleBounce(const FlatReturn& r, const FlatReturn& first, const RadarParams& p) {
  if (!r.has_rate || !first.has_rate || r.amplitude > first.amplitude) return false;
  return std::abs(first.rate) > kDoubleSigmas * p.rate_sigma &&
         std::abs(r.rate - 2 * first.rate) < kDoubleSigmas * p.rate_sigma &&
         std::abs(r.range - 2 * first.range) < kDoubleSigmas * p.range_sigma &&
         std::abs(wrapAngle(r.bearing - first.bearing)) < p.bearing_sigma;
}

bool oneObject(const FlatReturn& a, const FlatReturn& b, const RadarParams& p) {
  if (a.has_rate != b.has_rate || std::abs(a.rate - b.rate) > p.merge_rate) return false;
  const double width = std::max(p.merge_width, a.range * p.bearing_sigma);
  return std::abs(a.range - b.range) <= p.merge_range &&
         a.range * std::abs(wrapAngle(a.bearing - b.bearing)) <= width;
}

/// The returns of each object; groups in the order of their strongest members.
std::vector<std::vector<const FlatReturn*>> groups(const std::vector<FlatReturn>& returns,
                                                   const RadarParams& params) {
  std::vector<const FlatReturn*> left;
  for (const auto& r : returns) left.push_back(&r);
  std::stable_sort(left.begin(), left.end(),
                   [](const auto* a, const auto* b) { return a->amplitude > b->amplitude; });
  std::vector<std::vector<const FlatReturn*>> out;
  while (!left.empty()) {
    const FlatReturn* strongest = left.front();
    const auto end = std::stable_partition(left.begin(), left.end(), [&](const FlatReturn* r) {
      return r == strongest || oneObject(*strongest, *r, params);
    });
    out.emplace_back(left.begin(), end);
    left.erase(left.begin(), end);
  }
  return out;
}

RadarTarget merge(const std::vector<const FlatReturn*>& members) {
  RadarTarget t;
  const double n = static_cast<double>(members.size());
  const double middle = members.front()->bearing;
  double range2 = 0, bearing2 = 0;
  for (const FlatReturn* r : members) {
    const double off = wrapAngle(r->bearing - middle);
    t.range += r->range / n, range2 += r->range * r->range / n;
    t.bearing += off / n, bearing2 += off * off / n;
    t.range_rate += r->rate / n;
  }
  t.range_spread = std::sqrt(std::max(0.0, range2 - t.range * t.range));
  t.bearing_spread = std::sqrt(std::max(0.0, bearing2 - t.bearing * t.bearing));
  t.bearing = wrapAngle(middle + t.bearing);
  t.has_rate = members.front()->has_rate;
  t.strongest = members.front()->index;
  t.returns = static_cast<int>(members.size());
  return t;
}

}  // namespace

void RadarParams::visit(ParamVisitor& v) {
  v.real("range_sigma", range_sigma, {0.01, 50}, "m", "noise of a return's range");
  v.angle("bearing_sigma_deg", bearing_sigma, {0.01, 45}, "noise of a return's bearing");
  v.real("rate_sigma", rate_sigma, {0.01, 20}, "m/s", "noise of a return's range rate");
  v.real("own_speed_sigma", own_speed_sigma, {0, 20}, "m/s", "noise of the vehicle's own velocity");
  v.real("merge_range", merge_range, {0, 20}, "m",
         "returns within this distance of a stronger one in range ...");
  v.real("merge_width", merge_width, {0, 20}, "m",
         "... and this one across the line of sight (at least bearing_sigma) are of one object");
  v.boolean(
      "drop_double_bounce", drop_double_bounce,
      "drop returns at twice the range and rate of a stronger one (object - vehicle - object)");
  model.visit(v);
  v.expert();
  v.boolean("upside_down", upside_down,
            "the unit is mounted upside down, which the log's pose does not include: bearings "
            "change sign");
}

std::vector<RadarTarget> radarTargets(const RadarReturns& data, const Pose3& T_level_sensor,
                                      const RadarParams& params, std::size_t& dropped) {
  std::vector<FlatReturn> returns = flatten(data, T_level_sensor, params, dropped);
  if (params.drop_double_bounce) {
    const std::vector<FlatReturn> all = returns;
    const auto ghost = [&](const FlatReturn& r) {
      return std::any_of(all.begin(), all.end(),
                         [&](const FlatReturn& first) { return isDoubleBounce(r, first, params); });
    };
    const auto end = std::remove_if(returns.begin(), returns.end(), ghost);
    dropped += static_cast<std::size_t>(returns.end() - end);
    returns.erase(end, returns.end());
  }
  std::vector<RadarTarget> targets;
  for (const auto& members : groups(returns, params)) targets.push_back(merge(members));
  return targets;
}

RadarFrontEnd::RadarFrontEnd(RadarParams params, const ClassTable& classes,
                             const DetectionModel& detection_model)
    : params_(params),
      model_(std::make_shared<const RadarModel>(classes, detection_model, params.model)) {}

Pose3 RadarFrontEnd::measuringPose(const SensorFrame& frame) const {
  const Pose3 sensor = frame.T_world_sensor();
  const Vector3 origin = sensor.translation();
  return makePose(origin.x(), origin.y(), origin.z(), yawOf(sensor));
}

void RadarFrontEnd::fill(const SensorFrame& frame, MeasurementScan& scan) const {
  const auto* data = std::get_if<RadarReturns>(&frame.data);
  if (data == nullptr) return;
  const Pose3 T_level_sensor = scan.state.T_world_sensor.inverse() * frame.T_world_sensor();
  for (const RadarTarget& t : radarTargets(*data, T_level_sensor, params_, scan.dropped)) {
    if (auto m = measure(t, scan.state)) {
      scan.measurements.push_back(std::move(*m));
    } else {
      ++scan.dropped;
    }
  }
}

std::optional<Measurement> RadarFrontEnd::measure(const RadarTarget& t,
                                                  const SensorState& state) const {
  // Bearing noise moves returns past the border of the view: dropping those would bias the rest
  // inward.
  const DetectionParams& view = model_->detection_model().params();
  if (t.range > view.range_max ||
      std::abs(t.bearing) > 0.5 * view.fov + kBorderSigmas * params_.bearing_sigma)
    return std::nullopt;
  const Vector2 velocity = sensorVelocity(state);
  const auto& pose = state.ego.uncertainty;
  const Vector3 pose_variance(pose.sigma_xy * pose.sigma_xy, pose.sigma_xy * pose.sigma_xy,
                              pose.sigma_yaw * pose.sigma_yaw);
  const double own2 = params_.own_speed_sigma * params_.own_speed_sigma;
  const double forward = yawOf(state.T_world_sensor);
  const Vector2 u(std::cos(forward + t.bearing), std::sin(forward + t.bearing));
  const Vector2 n(-u.y(), u.x());
  Measurement m;
  m.z = Vector3(t.range, t.bearing, t.range_rate);
  m.seen = t.has_rate ? RadarModel::kAll : RadarModel::kNoRate;
  m.detection = t.strongest;
  // Derivatives with respect to the vehicle's x, y, yaw (method.md 1.3); yaw also changes the own
  // velocity along the line of sight.
  const Eigen::RowVector3d bearing(-n.x() / t.range, -n.y() / t.range, -1);
  Eigen::Matrix3d J;
  J.row(RadarModel::kRange) << -u.x(), -u.y(), 0;
  J.row(RadarModel::kBearing) = bearing;
  J.row(RadarModel::kRate) << -n.dot(velocity) * bearing.head<2>(), 0;
  m.R = J * pose_variance.asDiagonal() * J.transpose();
  m.R(0, 0) += params_.range_sigma * params_.range_sigma + t.range_spread * t.range_spread;
  m.R(1, 1) += params_.bearing_sigma * params_.bearing_sigma + t.bearing_spread * t.bearing_spread;
  m.R(2, 2) += params_.rate_sigma * params_.rate_sigma + own2;
  if (!t.has_rate) {
    m.z[RadarModel::kRate] = 0;
    m.R.row(RadarModel::kRate).setZero(), m.R.col(RadarModel::kRate).setZero();
  }
  m.position = state.T_world_sensor.translation().head<2>() + t.range * u;
  m.position_sigma = std::sqrt(std::max(m.R(0, 0), t.range * t.range * m.R(1, 1)));
  return m;
}

std::unique_ptr<FrontEnd> makeRadarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes) {
  const std::string section = "sensor." + sensor_label;
  const auto radar = config.read<RadarParams>(section + ".radar");
  const DetectionModel detection_model =
      DetectionModel::read(config, section, classes, {"target"}, radarDefaults());
  return std::make_unique<RadarFrontEnd>(radar, classes, detection_model);
}

}  // namespace perception
