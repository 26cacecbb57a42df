#include "libperception/measurement/objects/ObjectClass.h"

#include "libperception/measurement/models/DetectionModel.h"

#include <numeric>

namespace perception {
namespace {

void visitMotion(ParamVisitor& v, const MotionModel*& motion) {
  const auto& models = motionModels();
  std::vector<std::string> names;
  int index = 0;
  for (const MotionModel& m : models) {
    if (&m == motion) index = static_cast<int>(names.size());
    names.push_back(m.name);
  }
  v.choice("motion", index, names, "motion model");
  motion = &models[static_cast<std::size_t>(index)];
}

}  // namespace

void ObjectClass::visit(ParamVisitor& v) {
  visitMotion(v, motion);
  v.choiceOf("shape", shape, {"pedestrian", "cyclist", "vehicle", "thing", "phantom"},
             "looks: what a classifier of lidar clusters tells of the class");
  v.real("accel_psd", accel_psd, {0, 100}, "m^2/s^3", "white acceleration, power spectral density");
  v.reals("mode_accel_psd", mode_accel_psd, -1, {0, 100}, "m^2/s^3",
          "one per motion mode, in place of accel_psd; empty: a single model");
  v.reals("mode_damping", mode_damping, -1, {0, 100}, "1/s",
          "one per mode: rate at which the speed decays");
  v.reals("mode_sojourn", mode_sojourn, -1, {0.01, 1e4}, "s", "one per mode: mean time in it");
  v.require(mode_damping.size() == modes() && mode_sojourn.size() == modes() && modes() != 1,
            "mode_accel_psd, mode_damping, mode_sojourn: expected one number per mode in each, two "
            "modes or more");
  v.real("yaw_rate_psd", yaw_rate_psd, {0, 10}, "rad^2/s", "white yaw rate (wheeled)");
  v.real("lateral_psd", lateral_psd, {0, 100}, "m^2/s^3",
         "white lateral acceleration (wheeled), bounds the yaw rate of fast objects; 0: no bound");
  v.real("position_psd", position_psd, {0, 10}, "m^2/s",
         "slip and model mismatch; the only process noise of a static object");
  v.real("length", length, {0.05, 40}, "m", "mean length");
  v.real("width", width, {0.05, 10}, "m", "mean width");
  v.real("height", height, {0.05, 10}, "m", "mean height");
  v.real("length_sigma", length_sigma, {0.001, 20}, "m", "spread of the length over objects");
  v.real("width_sigma", width_sigma, {0.001, 10}, "m", "spread of the width over objects");
  v.real("height_sigma", height_sigma, {0.001, 10}, "m", "spread of the height over objects");
  v.real("prior", prior, {1e-6, 1}, "", "share among newborn objects");
  v.real("max_speed", max_speed, {0, 100}, "m/s", "largest plausible speed");
  v.boolean("reported", reported,
            "false: not a road user, but still in tracks.csv; the KITTI export and "
            "perception-calibrate use it, perception-evaluate takes --unnamed instead");
  v.text("kitti_type", kitti_type, "type in KITTI exports");
}

double ObjectClass::yawRatePsd(double speed) const {
  const double v2 = speed * speed;
  return lateral_psd > 0 && yaw_rate_psd * v2 > lateral_psd ? lateral_psd / v2 : yaw_rate_psd;
}

std::vector<std::string> ClassTable::names() const {
  std::vector<std::string> names;
  for (const ObjectClass& c : classes) names.push_back(c.name);
  return names;
}

ClassId ClassTable::find(const std::string& name) const {
  for (ClassId c = 0; c < size(); ++c) {
    if ((*this)[c].name == name) return c;
  }
  return -1;
}

ClassTable readClassTable(Config& config) {
  const std::string prefix = "class.";
  ClassTable table;
  for (const auto& section : config.sectionsWithPrefix(prefix)) {
    table.classes.push_back(config.read<ObjectClass>(section));
    table.classes.back().name = section.substr(prefix.size());
    if (table.classes.back().name == "front")
      config.fault(section, "", "no class has this name: tracks.csv has a column p_front");
  }
  if (table.classes.empty()) {
    config.fault("", "", "no [class.NAME] section: include classes.ini");
    return table;
  }
  const double total =
      std::accumulate(table.classes.begin(), table.classes.end(), 0.0,
                      [](double sum, const ObjectClass& c) { return sum + c.prior; });
  for (auto& c : table.classes) c.prior /= total;
  checkDetectionTables(config, table);
  return table;
}

}  // namespace perception
