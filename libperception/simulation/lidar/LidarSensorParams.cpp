#include "libperception/simulation/lidar/LidarSensorParams.h"

namespace perception {

LidarSensorParams LidarSensorParams::fourLayer() {
  LidarSensorParams p;
  p.layout = Layout::kFourLayer;
  p.azimuth_from = radians(-55), p.azimuth_to = radians(55);
  p.azimuth_step = radians(0.25);
  p.range_min = 0.3;
  p.range_max = 200;
  p.range_noise = 0.04;
  p.label_error = 0.01;
  return p;
}

void LidarSensorParams::visit(ParamVisitor& v) {
  v.angle("azimuth_from_deg", azimuth_from, {-180, 180}, "right end of the view");
  v.angle("azimuth_to_deg", azimuth_to, {-180, 180}, "left end of the view");
  v.angle("azimuth_step_deg", azimuth_step, {0.02, 10}, "between neighboring beams");
  v.angle("elevation_from_deg", elevation_from, {-90, 90}, "leaves lower rings out");
  v.angle("elevation_to_deg", elevation_to, {-90, 90}, "leaves higher rings out");
  v.real("range_min", range_min, {0, 100}, "m", "nothing nearer");
  v.real("range_max", range_max, {1, 500}, "m", "nothing farther");
  v.real("reference_range", reference_range, {1, 2000}, "m",
         "a 90 % surface is just seen (method.md 9)");
  v.angle("divergence_deg", divergence, {0, 2}, "width of the beam; 0: a ray without width");
  v.require(azimuth_from < azimuth_to, "azimuth_from_deg: expected less than azimuth_to_deg");
  v.require(range_min < range_max, "range_min: expected less than range_max");
  v.expert();
  v.integer("ring_step", ring_step, {1, 64}, "keeps every n-th ring");
  v.boolean("sweep", sweep, "beams at their own times while everything moves");
}

// HDL-64E: 32 upper lasers from +2 to -8.33 deg at 1/3 deg, 32 lower ones from -8.83 at 1/2 deg.
std::vector<double> LidarSensorParams::elevations() const {
  if (!rings.empty()) return rings;
  std::vector<double> result;
  if (layout == Layout::kFourLayer) return {radians(-1.2), radians(-.4), radians(.4), radians(1.2)};
  for (int i = 31; i >= 0; --i) result.push_back(radians(-8.83 - .5 * i));
  for (int i = 31; i >= 0; --i) result.push_back(radians(2 - i / 3.0));
  return result;
}

}  // namespace perception
