#pragma once
#include <functional>

#include "libperception/core/math/Angle.h"
#include "libperception/pipeline/safety/SafetyMonitor.h"
#include "tests/support/StartStamp.h"

namespace perception::test {

/// A scan of a box one meter wide and high at `x` [m] ahead, and of the road before it.
struct BoxScan {
  SensorFrame frame;
  PlacedReturns returns;

  BoxScan(double t, double x, float trust = 1) {
    frame.stamp = kStart + t;
    frame.ego.stamp = frame.stamp;
    frame.T_ego_sensor = makePose(0, 0, 1.7, 0);
    frame.data = LidarCloud{};
    for (double y = -0.5; y <= 0.5; y += 0.1)
      for (double z = 0.4; z <= 1; z += 0.1) add(x, y, z, trust);
    for (double road = 4; road < x; road += 0.2) add(road, 0, 0, 1);
    returns.height_min = 0.3, returns.height_max = 3;
    returns.vehicle_front = 2;
  }
  /// Trust of the box's returns.
  void trustBox(float trust) {
    auto& cloud = std::get<LidarCloud>(frame.data);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud.z[i] > 0) cloud.trust[i] = trust;
  }
  /// Share of the directions about every return that end there.
  void solid(float share) { returns.solid.assign(returns.size(), share); }
  /// A cloud of drops over the road before the box, one return each 0.1 m.
  void addCloud(float trust) {
    for (double x = 10; x < 19; x += 0.1)
      for (const double y : {-.4, 0., .4}) add(x, y, 1, trust);
  }

 private:
  void add(double px, double py, double pz, float trusted) {
    auto& cloud = std::get<LidarCloud>(frame.data);
    returns.source.push_back(static_cast<std::uint32_t>(cloud.x.size()));
    for (auto* v : {&returns.x, &cloud.x}) v->push_back(static_cast<float>(px));
    for (auto* v : {&returns.y, &cloud.y}) v->push_back(static_cast<float>(py));
    for (auto* v : {&returns.z, &cloud.z}) v->push_back(static_cast<float>(pz));
    returns.height.push_back(static_cast<float>(pz));
    cloud.trust.push_back(trusted);
  }
};

inline EgoState egoDriving(double t, double speed) {
  EgoState ego;
  ego.stamp = kStart + t;
  ego.velocity = {speed, 0};
  return ego;
}

inline Scene sceneDriving(double t, double speed) {
  Scene scene;
  scene.stamp = kStart + t;
  scene.ego = egoDriving(t, speed);
  return scene;
}

inline GridParams gridOfBox() {
  GridParams grid;
  grid.size = 60;
  return grid;
}

/// Scans 0.1 s apart as they are, in air that is not clear with that probability.
inline PathAhead afterScans(int scans, double weather, const std::function<void(BoxScan&)>& change,
                            double speed = 10) {
  SafetyMonitor monitor(gridOfBox(), {});
  PathAhead path;
  for (int k = 0; k < scans; ++k) {
    BoxScan scan(0.1 * k, 20);
    scan.frame.causes.weather = weather;
    change(scan);
    monitor.add(scan.frame, scan.returns);
    path = monitor.pathAhead(egoDriving(0.1 * k, speed));
  }
  return path;
}

}  // namespace perception::test
