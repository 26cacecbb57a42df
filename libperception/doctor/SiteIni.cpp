#include "libperception/doctor/SiteIni.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace perception {
namespace {

/// [m] Beyond, clusters of a 64-beam lidar are too thin to tell (method.md 8.1).
constexpr double kClusterRange = 70;
/// Share of the returns that range and field of view hold; the rest are strays.
constexpr double kNearlyAll = 0.999;
/// [m] A car's ends from an origin below its roof lidar, as in ini/kitti.ini, and how far a body
/// reaches beyond the outermost sensor.
constexpr double kFront = 2.4, kRear = 2.6, kBeyond = 0.3;
/// [m] An origin this near a lidar lies below it, not at the rear axle.
constexpr double kBelow = 0.5;
/// Share of a radar's returns that exist in one scan only, as in ini/aimotive.ini.
constexpr double kRadarClutter = 0.7;

constexpr const char* kHead =
    R"(; Written by perception-doctor for {log}: what was found there, and for the rest the values of
; recordings on streets. To do by hand: [class.NAME] prior for other places, scores of detectors (perception-calibrate).
include = {classes}

[run]
seed = 1
association = ranked
sensors = {letters}

[particle_filter]
PF_algorithm = pfOptimalProposal
resamplingMethod = prSystematic
BETA = 0.5
sampleSize = 20

; Nine in ten clusters on a street are trunks, poles, hedges and walls.
[class.pedestrian]
prior = 0.04
[class.cyclist]
prior = 0.02
[class.car]
prior = 0.10
[class.bus]
prior = 0.003
[class.static-other]
prior = 0.837
)";

constexpr const char* kShapes =
    R"(position_psd = 0.05          ; [m^2/s] the middle of a hedge moves with the view

[filter]
side_exponent = 0.5          ; cars and buses have one shape to a lidar
)";

constexpr const char* kGrid = R"(
[grid]
enabled = true

[grid.stop]
deceleration = 4
reaction = 0.5
)";

constexpr const char* kSensor = R"(
[sensor.{label}]
kind = {kind}
modality = {letter}
clutter_per_scan = {clutter}
births_per_scan = {births}
range_max = {range:.0f}
fov_deg = {fov:.0f}
)";

constexpr const char* kPositions = R"([sensor.{label}.class.pedestrian]
label.person = 0.95
label.cyclist = 0.04
label.car = 0.01
[sensor.{label}.class.cyclist]
label.person = 0.04
label.cyclist = 0.95
label.car = 0.01
[sensor.{label}.class.car]
label.person = 0.001
label.cyclist = 0.001
label.car = 0.998
[sensor.{label}.class.bus]
label.person = 0.001
label.cyclist = 0.001
label.car = 0.998
[sensor.{label}.class.static-other]
detection = 0.4
label.person = 0.3
label.cyclist = 0.1
label.car = 0.6
[sensor.{label}.positions]
labels = car, person, cyclist
)";

constexpr double kLeastHeight = 0.05, kAssumedHeight = 0.5;  ///< [m] of a scanner with one layer
constexpr const char* kPlanar = R"([sensor.{label}.points]
vehicle_front = {front:.2f}
vehicle_rear = 0.1
[sensor.{label}.obstacles]
height_min = {least:.2f}
occluder_min = {top:.2f}
[sensor.{label}.clusters]
min_top = {top:.2f}
min_points = 5
[sensor.{label}.persons]
min_span = 0
min_points = 4
)";

double tens(double value) { return 10 * std::ceil(value / 10); }

/// Full angle in whole degrees; nearly all around is all around.
double fieldOf(double angle) {
  const double wide = std::ceil(degrees(angle));
  return wide > 330 ? 360 : std::clamp(wide, 1.0, 360.0);
}

std::string section(const std::string& label, const char* kind, char letter, double clutter,
                    double births, double range, double fov) {
  return fmt::format(kSensor, fmt::arg("label", label), fmt::arg("kind", kind),
                     fmt::arg("letter", letter), fmt::arg("clutter", clutter),
                     fmt::arg("births", births), fmt::arg("range", range), fmt::arg("fov", fov));
}

/// "names = Car=car, ..." of the names that were found and are known.
std::string namesLine(const SensorFacts& facts, bool cyclists) {
  std::string pairs;
  for (const auto& [name, count] : facts.names) {
    std::string ours = knownName(name);
    if (ours.empty()) continue;
    if (cyclists && (name == "Cyclist" || name == "cyclist")) ours = "cyclist";
    pairs += (pairs.empty() ? "" : ", ") + name + "=" + ours;
  }
  return pairs.empty() ? "" : "names = " + pairs + "\n";
}

std::string poseLine(const Pose3& pose, const char* why) {
  const Vector3 t = pose.translation();
  return fmt::format("pose = {:.3f}, {:.3f}, {:.3f}, {:.2f}, {:.2f}, {:.2f}   ; {}\n", t.x(), t.y(),
                     t.z(), degrees(yawOf(pose)), degrees(pitchOf(pose)), degrees(rollOf(pose)),
                     why);
}

/// The log's mounting, corrected where it is wrong: by the motion against the poses, height, pitch
/// and roll by the ground where that is seen. Empty where nothing is wrong.
std::string mountingLine(const LogSurvey& survey, const SensorFacts& facts) {
  const auto ground = groundMounting(facts);
  auto motion = survey.motionCheck(facts);
  Pose3 pose = facts.T_ego_sensor;
  if (ground && ground->steady() && motion) motion->pitch = motion->roll = MotionCheck::Value{};
  if (ground && ground->wrong()) pose = ground->T_ego_sensor;
  if (motion) pose = correctedMounting(*motion, pose);
  return pose.isApprox(facts.T_ego_sensor, 1e-6)
             ? ""
             : poseLine(pose, "the log's, corrected by ground and motion");
}

/// Where the own vehicle ends: beyond its outermost sensors.
std::string vehicleLines(const LogSurvey& survey, const SensorFacts& lidar) {
  const bool below = lidar.T_ego_sensor.translation().head<2>().norm() < kBelow;
  double front = below ? kFront : 3.8, rear = below ? kRear : 2.0;  // PointParams: a rear axle
  for (const auto& [label, facts] : survey.sensors()) {
    if (facts.frames == 0 || facts.pose_varies) continue;
    const double x = facts.T_ego_sensor.translation().x();
    if (facts.kind == "radar") front = std::max(front, x + kBeyond);
    if (facts.kind == "radar") rear = std::max(rear, kBeyond - x);
  }
  return fmt::format("vehicle_front = {:.1f}\nvehicle_rear = {:.1f}\n", std::min(front, 20.0),
                     std::min(rear, 20.0));
}

std::string lidarSection(const LogSurvey& survey, const std::string& label,
                         const SensorFacts& facts, const SiteFiles& files) {
  const double range = std::clamp(tens(facts.rangeBelow(kNearlyAll)), 10.0, kClusterRange);
  std::string out = section(label, "lidar", 'L', 2, 0.5, range, fieldOf(facts.angleOf(kNearlyAll)));
  out += fmt::format("label_exponent = 0.05\n");
  if (!files.model.empty()) out += "detection_exponent = 0.02\ncorner_radius = 0.3\n";
  out += mountingLine(survey, facts);
  out += fmt::format("[sensor.{}.points]\n{}", label, vehicleLines(survey, facts));
  if (!files.model.empty())
    out += fmt::format("[sensor.{}.classifier]\nfile = {}\n", label, files.model);
  return out;
}

/// One-layer scanners: what they see of an object is one line at their height, and nothing of the
/// own vehicle. `label`: of the section; `merge`: empty, or the scanners that it holds.
std::string planarSection(const std::string& label, const std::string& merge,
                          const SensorFacts& facts) {
  Pose3 pose = facts.T_ego_sensor;
  const bool unknown = pose.translation().z() < kLeastHeight;
  if (unknown) pose.translation().z() = kAssumedHeight;
  const double height = pose.translation().z();
  std::string out = section(label, "lidar", 'L', 2, 0.5, kClusterRange,
                            merge.empty() ? fieldOf(facts.angleOf(kNearlyAll)) : 360);
  if (!merge.empty())
    out += "merge = " + merge + "\n";
  else if (unknown)
    out += poseLine(pose, "the log has it on the ground: height assumed");
  return out + fmt::format(kPlanar, fmt::arg("label", label),
                           fmt::arg("front", std::max(0.1, pose.translation().x())),
                           fmt::arg("least", std::clamp(height - 0.3, 0.05, 0.2)),
                           fmt::arg("top", std::clamp(height - 0.2, 0.05, 0.3)));
}

std::string radarSection(const LogSurvey& survey, const std::string& label,
                         const SensorFacts& facts) {
  const double returns = static_cast<double>(facts.returns) / static_cast<double>(facts.frames);
  std::string out =
      section(label, "radar", 'R', std::max(0.1, std::round(kRadarClutter * returns)), 0.1,
              std::max(10.0, tens(facts.rangeBelow(1))), fieldOf(2 * facts.farthest_bearing));
  return out + mountingLine(survey, facts);
}

std::string boxesSection(const std::string& label, const SensorFacts& facts) {
  const double fov = facts.farthest_bearing > 0 ? fieldOf(2 * facts.farthest_bearing) : 80;
  const std::string names = namesLine(facts, false);
  std::string out = section(label, "boxes", 'C', 0.15, 0.05, kClusterRange, fov);
  return out + (names.empty() ? "" : fmt::format("[sensor.{}.detector]\n{}", label, names));
}

std::string positionsSection(const std::string& label, const SensorFacts& facts) {
  std::string out = section(label, "positions", 'L', 4, 0.1,
                            std::max(10.0, tens(facts.rangeBelow(1))), fieldOf(facts.angleOf(1)));
  const std::string names = namesLine(facts, true);
  // Boxes without a known name are "object", which is the default.
  return out + (names.empty() ? "" : fmt::format(kPositions, fmt::arg("label", label)) + names);
}

}  // namespace

std::string knownName(const std::string& name) {
  static const std::set<std::string> cars = {"Car", "Van",   "Truck", "Bus",     "Tram",
                                             "car", "van",   "truck", "bus",     "tram",
                                             "CAR", "TRUCK", "BUS",   "vehicle", "Vehicle"};
  static const std::set<std::string> persons = {
      "Pedestrian", "Person", "Person_sitting", "Cyclist", "pedestrian", "person",
      "cyclist",    "rider",  "bicycle",        "PERSON",  "PEDESTRIAN", "motorcycle"};
  if (cars.count(name) != 0) return "car";
  return persons.count(name) != 0 ? "person" : "";
}

std::string siteIni(const LogSurvey& survey, const SiteFiles& files, const std::string& log) {
  std::string sections, layers, letters;
  bool clouds = false, intensity = false;
  const auto use = [&letters](char letter) {
    if (letters.find(letter) == std::string::npos)
      letters += (letters.empty() ? "" : "+") + std::string(1, letter);
  };
  const SensorFacts* planar = nullptr;
  for (const auto& [label, facts] : survey.sensors()) {
    if (facts.frames == 0 || label.empty() || label.find('.') != std::string::npos) continue;
    if (facts.planar) {
      layers += (layers.empty() ? "" : ", ") + label;
      planar = &facts;
    } else if (facts.kind == "lidar") {
      sections += lidarSection(survey, label, facts, files);
      clouds = true, intensity = intensity || (facts.high && *facts.high > *facts.low);
    } else if (facts.kind == "radar") {
      sections += radarSection(survey, label, facts);
      use('R');
    } else if (facts.kind == "boxes") {
      sections += boxesSection(label, facts);
      use('C');
    } else if (facts.kind == "positions") {
      sections += positionsSection(label, facts);
      use('L');
    }
  }
  if (planar != nullptr) {
    const bool one = layers.find(',') == std::string::npos;
    sections += planarSection(one ? layers : "SCANNERS", one ? "" : layers, *planar);
  }
  if (clouds || planar != nullptr) use('L');
  if (letters.empty()) return "";
  std::string out = fmt::format(kHead, fmt::arg("log", log), fmt::arg("classes", files.classes),
                                fmt::arg("letters", letters));
  if (clouds && !files.model.empty()) out += kShapes;
  if (clouds) out += kGrid;
  if (clouds && survey.poses().empty() && survey.motion().empty())
    out += "\n[ego]\nsource = lidar               ; the log has no other ego motion\n";
  if (intensity) out += "\n[weather]\nfilter = trust\n";
  return out + sections;
}

}  // namespace perception
