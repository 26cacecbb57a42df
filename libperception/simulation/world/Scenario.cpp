#include "libperception/simulation/world/Scenario.h"

#include <algorithm>
#include <array>
#include <map>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

/// Defaults of a kind.
struct KindRow {
  const char* name;
  const char* truth_type;
  bool road_user;
  double length, width,
      height;  ///< [m] classes.ini (method.md 2.2); van, pole, box, bush: usual ones
};
constexpr std::array<KindRow, 8> kKinds = {{{"car", "Car", true, 4.5, 1.8, 1.5},
                                            {"van", "Van", true, 5.2, 2.0, 2.1},
                                            {"bus", "Truck", true, 11, 2.55, 3.2},
                                            {"cyclist", "Cyclist", true, 1.8, 0.6, 1.7},
                                            {"pedestrian", "Pedestrian", true, 0.5, 0.5, 1.7},
                                            {"pole", "Misc", false, 0.15, 0.15, 4},
                                            {"box", "Misc", false, 10, 1, 4},
                                            {"bush", "Misc", false, 1.2, 1.2, 1.2}}};

const KindRow& row(ObjectKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::vector<std::string> kindNames() {
  std::vector<std::string> names;
  for (const KindRow& kind : kKinds) names.emplace_back(kind.name);
  return names;
}

// Purposes of random numbers.
constexpr std::uint32_t kVariationStream = 0x51D00, kTrialStream = 0x51D01;

constexpr Bounds kPlace = {-1000, 1000};  // [m] single floats of the ray caster stay below 0.1 mm
constexpr Bounds kTime = {-3600, 3600};   // [s]

}  // namespace

bool isRoadUser(ObjectKind kind) { return row(kind).road_user; }
const char* truthType(ObjectKind kind) { return row(kind).truth_type; }

void ScenarioParams::visit(ParamVisitor& v) {
  v.text("description", description, "one line for the log's first comment");
  v.real("duration", duration, {0.1, 3600}, "s", "length of the log");
  v.real("rate", rate, {0.1, 100}, "1/s", "frame numbers and instants of the truth");
  v.expert();
  v.real("ground_roughness", ground_roughness, {0, 0.2}, "m", "spread of the road's height");
}

void WaypointParams::visit(ParamVisitor& v) {
  v.reals("t", t, -1, kTime, "s", "times of the waypoints; the same place twice is a pause");
  v.reals("x", x, -1, kPlace, "m", "their places, world");
  v.reals("y", y, -1, kPlace, "m", "their places, world");
  v.angle("heading_deg", heading, {-360, 360}, "of an object at rest; else along the path");
  const std::string fault = Trajectory::fault(t, x, y);
  v.require(fault.empty(), fault);
}

void PoseParams::visit(ParamVisitor& v) {
  v.real("pose_rate", rate, {0, 1000}, "1/s",
         "of the pose estimator ([radecki2016]: 100 Hz); 0: none");
  v.real("pose_sigma_xy", sigma_xy, {0, 10}, "m", "correlated error of the estimated pose");
  v.angle("pose_sigma_yaw_deg", sigma_yaw, {0, 10}, "correlated error of the estimated heading");
}

void EgoParams::visit(ParamVisitor& v) {
  waypoints.visit(v);
  pose.visit(v);
}

void RoadParams::visit(ParamVisitor& v) {
  v.reals("x", x, -1, kPlace, "m", "of the middle line, world");
  v.reals("y", y, -1, kPlace, "m", "of the middle line, world");
  v.real("width", width, {0.5, 100}, "m", "of the asphalt");
  v.require(x.size() == y.size() && x.size() >= 2, "x, y: expected two or more values of each");
}

void LaneSection::visit(ParamVisitor& v) {
  v.reals("x", x, -1, kPlace, "m", "of the center line in driving direction, world");
  v.reals("y", y, -1, kPlace, "m", "of the center line in driving direction, world");
  v.real("width", width, {0.5, 20}, "m", "of the lane");
  v.require(x.size() == y.size() && x.size() >= 2, "x, y: expected two or more values of each");
  v.expert();
  v.boolean("one_way", one_way, "false: driven either way");
}

void ObjectParams::visit(ParamVisitor& v) {
  const ObjectKind before = kind;
  v.choiceOf("kind", kind, kindNames(), "shape, usual size and truth type");
  if (kind != before) {  // loading: the usual size of that kind
    length = row(kind).length, width = row(kind).width, height = row(kind).height;
  }
  v.real("length", length, {0.02, 500}, "m", "along the heading");
  v.real("width", width, {0.02, 500}, "m", "across");
  v.real("height", height, {0.02, 100}, "m", "bottom to top");
  v.real("base", base, {-5, 50}, "m", "height of the bottom above the road");
  v.real("reflectivity", reflectivity, {0.01, 3}, "-", "factor on that of its materials");
  v.text("party", party, "objects of one party vary together from trial to trial");
  waypoints.visit(v);
}

void SensorParams::visit(ParamVisitor& v) {
  const SensorKind before = kind;
  v.choiceOf("kind", kind,
             {"lidar64", "lidar4", "camera_boxes", "spherical_camera", "camera_images", "radar",
              "gnss", "imu", "wheels"},
             "kind of sensor");
  if (kind != before && kind == SensorKind::kLidar4) lidar = LidarSensorParams::fourLayer();
  v.real("x", x, {-20, 20}, "m", "place on the vehicle: forward of the rear axle");
  v.real("y", y, {-20, 20}, "m", "left");
  v.real("z", z, {0, 20}, "m", "above the road");
  v.angle("yaw_deg", yaw, {-360, 360}, "of its forward axis, to the left");
  v.angle("pitch_deg", pitch, {-90, 90}, "down");
  v.angle("roll_deg", roll, {-180, 180}, "about its forward axis");
  v.real("rate", rate, {0.1, 1000}, "1/s", "scans, images or readings");
  v.real("phase", phase, {0, 10}, "s", "time of the first one");
  switch (kind) {
    case SensorKind::kLidar64:
    case SensorKind::kLidar4:
      return lidar.visit(v);
    case SensorKind::kCameraBoxes:
      return camera.visit(v);
    case SensorKind::kSphericalCamera:
      return panorama.visit(v);
    case SensorKind::kCameraImages:
      return images.visit(v);
    case SensorKind::kRadar:
      return radar.visit(v);
    case SensorKind::kGnss:
      return gnss.visit(v);
    case SensorKind::kImu:
      return imu.visit(v);
    case SensorKind::kWheels:
      return wheels.visit(v);
  }
}

void VariationParams::visit(ParamVisitor& v) {
  v.integer("trials", trials, {1, 1000}, "of this scenario; --trial N plays one");
  v.real("start", start, {0, 60}, "s", "largest shift of a moving object's start time");
  v.real("pace", pace, {0, 0.5}, "-",
         "largest relative change of a moving object's speed, about t = 0");
  v.real("place", place, {0, 10}, "m", "largest shift of a moving object's path in x and y");
}

Scenario readScenario(Config& config) {
  Scenario scenario;
  scenario.params = config.read<ScenarioParams>("scenario", {}, true);
  scenario.ego = config.read<EgoParams>("ego", {}, true);
  scenario.variation = config.read<VariationParams>("variation");
  scenario.light = config.read<Lighting>("light");
  scenario.weather = config.read<SimulatedWeatherParams>("weather");
  const std::string object_prefix = "object.", road_prefix = "road.", lane_prefix = "lane.";
  for (const std::string& section : config.sectionsWithPrefix(road_prefix)) {
    RoadParams road;
    road.name = section.substr(road_prefix.size());
    scenario.roads.push_back(config.read(section, road));
  }
  for (const std::string& section : config.sectionsWithPrefix(lane_prefix)) {
    const auto read = config.read<LaneSection>(section);
    Lane lane{section.substr(lane_prefix.size()), {}, read.width, read.one_way};
    for (std::size_t i = 0; i < std::min(read.x.size(), read.y.size()); ++i)
      lane.points.emplace_back(read.x[i], read.y[i]);
    scenario.lanes.push_back(std::move(lane));
  }
  for (const std::string& section : config.sectionsWithPrefix(object_prefix)) {
    ObjectParams object;
    object.name = section.substr(object_prefix.size());
    scenario.objects.push_back(config.read(section, object));
  }
  scenario.sensors = readSensors(config);
  if (scenario.sensors.empty()) {
    config.fault("scenario", "", "no [sensor.LABEL] section: expected at least one sensor");
  }
  return scenario;
}

std::vector<SensorParams> readSensors(Config& config) {
  const std::string prefix = "sensor.";
  std::vector<SensorParams> sensors;
  for (const std::string& section : config.sectionsWithPrefix(prefix)) {
    SensorParams sensor;
    sensor.label = section.substr(prefix.size());
    sensors.push_back(config.read(section, sensor));
  }
  return sensors;
}

Scenario trialOf(Scenario scenario, int trial, std::uint64_t seed) {
  if (trial <= 0) return scenario;
  const VariationParams& vary = scenario.variation;
  // Slot 0 is the ego's; an object's is its place in the file, a party's that of its first member.
  const auto apply = [&](WaypointParams& way, std::size_t slot) {
    if (way.t.size() < 2) return;
    Rng rng({seed, static_cast<std::uint64_t>(trial), static_cast<std::uint32_t>(slot),
             kVariationStream});
    const double shift = vary.start * rng.uniform(-1, 1);
    const double stretch = 1 / (1 + vary.pace * rng.uniform(-1, 1));
    const double dx = vary.place * rng.uniform(-1, 1), dy = vary.place * rng.uniform(-1, 1);
    for (double& t : way.t) t = shift + t * stretch;
    for (double& x : way.x) x += dx;
    for (double& y : way.y) y += dy;
  };
  apply(scenario.ego.waypoints, 0);
  std::map<std::string, std::size_t> first;
  for (std::size_t i = 0; i < scenario.objects.size(); ++i) {
    ObjectParams& object = scenario.objects[i];
    std::size_t slot = i + 1;
    if (!object.party.empty()) slot = first.emplace(object.party, slot).first->second;
    apply(object.waypoints, slot);
  }
  return scenario;
}

std::uint64_t trialSeed(std::uint64_t seed, int trial) {
  if (trial <= 0) return seed;
  Rng rng({seed, static_cast<std::uint64_t>(trial), 0, kTrialStream});
  const std::uint64_t high = rng();
  return high << 32 | rng();
}

}  // namespace perception
