#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/filter/Step.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/radar/RadarModel.h"
#include "libperception/simulation/RadarUnit.h"
#include "libperception/simulation/cameras/SphericalCamera.h"
#include "libperception/simulation/lidar/LidarCaster.h"
#include "libperception/simulation/world/World.h"

namespace perception {
namespace {

std::string ini(const std::string& name) {
  return std::string(PERCEPTION_SOURCE_DIR) + "/ini/" + name;
}

/// [radecki2016]'s scenario A (simulated) by its eight radars alone, with the vehicle's site INI.
struct Played {
  int in_view = 0;    ///< scans while the Suburban moved within 40 m in front
  int tracked = 0;    ///< of these with an object within 2 m of it
  double speed2 = 0;  ///< sum of squares of the velocity's error [m/s]
  int strangers = 0;  ///< named objects with a return within a second, none of the scenario's
                      ///< within 3 m; summed over scans. (What coasts on between the narrow views
                      ///< is none of the radars' doing.)
  int scans = 0;
};

Played play(double from, double to) {
  Config site = Config::fromFile(ini("skynet.ini"));
  const PipelineSetup setup = PipelineSetup::read(site);
  Config file = Config::fromFile(ini("scenarios/A.ini"));
  const World world(readScenario(file));
  LidarCaster caster(world);
  Posterior posterior = Posterior::empty(8);
  Played out;
  std::uint64_t scan_index = 0;
  for (int i = 0; from + 0.1 * i <= to; ++i) {
    int unit_number = 0;
    for (const SensorParams& unit : world.scenario().sensors) {
      const auto sensor = std::find_if(setup.sensors.begin(), setup.sensors.end(),
                                       [&](const auto& k) { return k.label == unit.label; });
      if (unit.label.rfind("RADAR", 0) != 0) continue;
      if (sensor == setup.sensors.end()) continue;
      const double t = from + 0.1 * i + 0.01 * unit_number++;
      caster.setTime(t);
      SensorFrame frame;
      frame.sensor = unit.label;
      frame.ego = world.ego(t);
      frame.stamp = frame.ego.stamp = world.stamp(t);
      frame.T_ego_sensor = unit.T_ego_sensor();
      RadarMount mount;
      mount.T_world_sensor = frame.T_world_sensor();
      mount.velocity = sensorVelocity({frame.stamp, mount.T_world_sensor, frame.ego});
      frame.data = radarReturns(caster, t, unit.radar, mount, RngKey{5, scan_index, 0, 0});
      const auto scan = sensor->front_end->extract(frame);
      posterior = step(posterior, scan, setup.model, RngKey{1, scan_index++, 0, 0}, 8).posterior;
    }
    const double t = from + 0.1 * i + 0.09;
    ++out.scans;
    const auto truth = world.truth(0, t);
    const EgoState ego = world.ego(t);
    const auto& best = *posterior.hypotheses[mapHypothesis(posterior).slot];
    std::vector<Vector4> named;
    for (const auto& track : best.tracks) {
      const auto c = track->likeliestClass();
      if (track->existence < 0.5 || !setup.model.classes[c].reported) continue;
      if (!setup.model.classes[c].motion->moves) continue;
      named.push_back(
          kinematicsOf(setup.model.classes[c], track->bank[std::size_t(c)]).q.head<4>());
      const Vector2 at = named.back().head<2>();
      if (track->stamp - track->last_hit[modalityIndex(Modality::kRadar)] > 1) continue;
      out.strangers += std::none_of(truth.begin(), truth.end(), [&](const TruthObject& o) {
        return (o.position.head<2>() - at).norm() < 3;
      });
    }
    for (const TruthObject& o : truth) {
      const Vector2 at = o.position.head<2>(), velocity(o.vx, o.vy);
      const Vector3 own = ego.T_world_ego.inverse() * o.position;
      if (o.type != "Car" || !(velocity.norm() >= 1) || own.x() < 3 || own.norm() > 40) continue;
      ++out.in_view;
      double nearest = 2, error = -1;
      for (const Vector4& x : named) {
        if ((x.head<2>() - at).norm() > nearest) continue;
        nearest = (x.head<2>() - at).norm(), error = (x.tail<2>() - velocity).squaredNorm();
      }
      if (error >= 0) ++out.tracked, out.speed2 += error;
    }
  }
  return out;
}

TEST(RadarScenario, EightRadarsAloneTrackTheOncomingSuburban) {
  const Played p = play(0, 16);
  ASSERT_GT(p.in_view, 40);
  EXPECT_GE(p.tracked, 0.8 * p.in_view);
  EXPECT_LE(std::sqrt(p.speed2 / p.tracked), 2);
  EXPECT_LE(p.strangers, 0.1 * p.scans);  // "radar has few false positives"
}

TEST(PanoramaScenario, BoxesOfTheSuburbanLieWhereItIs) {
  // The same encounter (simulated) in the 2k panorama: every residual against its stated deviation.
  Config site = Config::fromFile(ini("skynet.ini"));
  const PipelineSetup setup = PipelineSetup::read(site);
  Config file = Config::fromFile(ini("scenarios/A.ini"));
  const World world(readScenario(file));
  LidarCaster caster(world);
  const auto named = [](const auto& s) { return s.label == "CAMERA_PANO"; };
  const auto& sensors = world.scenario().sensors;
  const auto unit = std::find_if(sensors.begin(), sensors.end(), named);
  const auto front_end = std::find_if(setup.sensors.begin(), setup.sensors.end(), named);
  ASSERT_TRUE(unit != sensors.end() && front_end != setup.sensors.end());
  int boxes = 0, near = 0, reversed = 0;
  Vector3 nis = Vector3::Zero();
  for (std::uint64_t i = 0; i < 60; ++i) {
    const double t = 11 + 0.08 * static_cast<double>(i);
    caster.setTime(t);
    SensorFrame frame;
    frame.ego = world.ego(t);
    frame.stamp = world.stamp(t);
    frame.T_ego_sensor = unit->T_ego_sensor() * opticalAxes();
    frame.data =
        detectPanorama(caster, t, unit->panorama, frame.T_world_sensor(), RngKey{6, i, 0, 0});
    const auto scan = front_end->front_end->extract(frame);
    for (const TruthObject& o : world.truth(0, t)) {
      if (o.type != "Car") continue;
      Kinematics k;
      k.q << o.position.x(), o.position.y(), o.vx, o.vy, o.yaw;
      k.has_yaw = true;
      const Extent extent{o.length, o.width, 0, 0};
      AxisPrediction p;
      scan.model->predict(&k, &extent, 1, scan.state, &p);
      for (const Measurement& m : scan.measurements) {
        if (!p.defined || m.label != 0 || p.h[2] > 15 || m.seen != FootprintModel::kAll) continue;
        const AxisVector y = residual(*scan.model, m, p.h);
        if (std::abs(y[0]) > radians(30) || std::abs(y[2]) > 6) continue;  // a false box
        ++boxes;
        nis += y.cwiseAbs2().cwiseQuotient(m.R.diagonal());
        if (!m.heading) continue;
        near += std::abs(wrapAxis(m.heading->yaw - o.yaw)) < 3 * m.heading->sigma;
        reversed += std::abs(wrapAngle(m.heading->yaw - o.yaw)) > kPi / 2;
      }
    }
  }
  ASSERT_GT(boxes, 30);
  for (int axis = 0; axis < 3; ++axis) EXPECT_LT(nis[axis] / boxes, 1.5) << axis;
  EXPECT_GE(near, 0.95 * boxes);
  EXPECT_LE(reversed, 0.4 * boxes);  // a fifth, by the simulated detector
  EXPECT_GE(reversed, 0.05 * boxes);
}

}  // namespace
}  // namespace perception
