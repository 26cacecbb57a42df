#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/filter/Step.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/radar/RadarFrontEnd.h"

namespace perception {
namespace {

FilterModel carsAndPosts() {
  FilterModel model;
  ObjectClass car, post;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.accel_psd = 1, car.yaw_rate_psd = 0.0685, car.position_psd = 0.01;
  car.length = 4.5, car.width = 1.8, car.length_sigma = 0.675, car.width_sigma = 0.27;
  car.max_speed = 50, car.prior = 0.5;
  post.name = "static-other";
  post.motion = findMotionModel("static");
  post.prior = 0.5;
  model.classes.classes = {car, post};
  return model;
}

struct Start {
  double seconds = 1e9;    ///< from the first scan until the speed is right to 1 m/s for good
  double final_error = 0;  ///< [m/s] of the speed at the end
};

/// A simulated car drives towards us in the next lane at 12 m/s while we drive at 10 m/s; a modern
/// unit sees it ten times a second from 70 m on, for three seconds.
Start startOf(bool with_rate, std::uint64_t seed) {
  const FilterModel model = carsAndPosts();
  DetectionParams s;
  s.modality = Modality::kRadar;
  s.births_per_scan = 0.1, s.clutter_per_scan = 0.01;
  s.range_max = 120, s.fov = radians(60);
  RadarParams p;
  if (!with_rate) p.model.min_birth_speed = 0;
  const RadarFrontEnd front_end(p, model.classes, DetectionModel(s, {{}, {}}, {"target"}));
  Rng rng({seed, 0, 0, 0});
  Posterior posterior = Posterior::empty(4);
  Start result;
  bool right = false;
  for (std::uint64_t i = 0; i <= 30; ++i) {
    const double t = 0.1 * static_cast<double>(i);
    SensorFrame frame;
    frame.stamp = frame.ego.stamp = Stamp::fromSeconds(1000 + t);
    frame.ego.T_world_ego = makePose(10 * t, 0, 0, 0);
    frame.ego.velocity = {10, 0};
    frame.T_ego_sensor = makePose(3.5, 0, 0.5, 0);
    const Vector2 near(73.5 - 2.25 - 12 * t, 3.6);  // the middle of its front
    const Vector2 d = near - frame.T_world_sensor().translation().head<2>();
    RadarReturn r;
    r.range = d.norm() + p.range_sigma * rng.normal();
    r.bearing = std::atan2(d.y(), d.x()) + p.bearing_sigma * rng.normal();
    r.range_rate = d.normalized().dot(Vector2(-22, 0)) + p.rate_sigma * rng.normal();
    r.has_rate = with_rate;
    frame.data = RadarReturns{{r}, 0};
    posterior =
        step(posterior, front_end.extract(frame), model, RngKey{seed, i, 0, 0}, 4).posterior;
    double speed = 0, existence = 0;
    for (const auto& track : posterior.hypotheses[mapHypothesis(posterior).slot]->tracks) {
      if (track->existence < existence) continue;
      existence = track->existence;
      speed = kinematicsOf(model.classes[0], track->bank[0]).q.segment<2>(2).norm();
    }
    result.final_error = std::abs(speed - 12);
    const bool is_right = existence > 0 && result.final_error < 1;
    if (is_right && !right) result.seconds = t;
    if (!is_right) result.seconds = 1e9;
    right = is_right;
  }
  return result;
}

TEST(RangeRateStart, OncomingCarsHaveTheirSpeedWithinAFifthOfASecond) {
  // method.md 4.3: .6 s and more by positions alone, .2 s with the range rate at birth.
  const int runs = 20;
  std::vector<double> with, without;
  for (int seed = 1; seed <= runs; ++seed) {
    with.push_back(startOf(true, static_cast<std::uint64_t>(seed)).seconds);
    without.push_back(startOf(false, static_cast<std::uint64_t>(seed)).seconds);
  }
  std::sort(with.begin(), with.end());
  std::sort(without.begin(), without.end());
  EXPECT_LE(with[runs / 2], 0.2);
  EXPECT_GE(without[runs / 2], 0.6);
}

}  // namespace
}  // namespace perception
