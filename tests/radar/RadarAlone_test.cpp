#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/filter/Step.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/radar/RadarFrontEnd.h"

namespace perception {
namespace {

FilterModel carsAndOthers() {
  FilterModel model;
  ObjectClass car, other;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.accel_psd = 1, car.yaw_rate_psd = 0.0685, car.position_psd = 0.01;
  car.length = 4.5, car.width = 1.8, car.length_sigma = 0.675, car.width_sigma = 0.27;
  car.max_speed = 50, car.prior = 0.5;
  other.name = "static-other";
  other.prior = 0.5;
  model.classes.classes = {car, other};
  return model;
}

/// A car that drives straight on.
struct Car {
  Vector2 start, velocity;  ///< [m, m/s] world; middle of the footprint
  Vector2 at(double t) const { return start + t * velocity; }
};

/// A drive at 12 m/s between guard rails whose posts return in every scan (simulated), with a car
/// ahead in the own lane, one that comes, and false returns. Scene after `seconds`.
struct Drive {
  double bearing_sigma = radians(2);
  std::vector<Car> cars{{{25, 0}, {15, 0}}, {{110, 3.6}, {-11, 0}}};
  int objects = 0;            ///< of existence .5 and more, at the end
  double worst_position = 0;  ///< [m] over the cars, nearest object
  double worst_speed = 0;     ///< [m/s]
  int most_objects = 0;       ///< at any instant after the first second

  void run(double seconds, std::uint64_t seed, RadarParams params) {
    const FilterModel model = carsAndOthers();
    DetectionParams s;
    s.modality = Modality::kRadar;
    s.births_per_scan = 0.05, s.clutter_per_scan = 0.5;
    s.range_max = 120, s.fov = radians(90);
    std::vector<ClassDetection> rows(2);
    rows[1].detection = 0.3;
    params.bearing_sigma = bearing_sigma;
    const RadarFrontEnd front_end(params, model.classes, DetectionModel(s, rows, {"target"}));
    Rng rng({seed, 1, 0, 0});
    Posterior posterior = Posterior::empty(8);
    for (std::uint64_t i = 0; 0.1 * static_cast<double>(i) <= seconds; ++i) {
      const double t = 0.1 * static_cast<double>(i);
      SensorFrame frame;
      frame.stamp = frame.ego.stamp = Stamp::fromSeconds(1000 + t);
      frame.ego.T_world_ego = makePose(12 * t, 0, 0, 0);
      frame.ego.velocity = {12, 0};
      frame.T_ego_sensor = makePose(3.5, 0, 0.5, 0);
      const Vector2 unit = frame.T_world_sensor().translation().head<2>();
      RadarReturns returns;
      const auto add = [&](const Vector2& point, const Vector2& velocity) {
        const Vector2 d = point - unit;
        RadarReturn r;
        r.range = d.norm() + params.range_sigma * rng.normal();
        r.bearing = std::atan2(d.y(), d.x()) + params.bearing_sigma * rng.normal();
        r.range_rate =
            d.normalized().dot(velocity - frame.ego.velocity) + params.rate_sigma * rng.normal();
        if (std::abs(r.bearing) < radians(45) && d.norm() < 115) returns.returns.push_back(r);
      };
      for (const Car& car : cars) {
        const Vector2 c = car.at(t);  // its end that looks at us
        if (rng.uniform() < 0.9) add({c.x() - 2.25, c.y() + rng.uniform(-0.9, 0.9)}, car.velocity);
      }
      for (int post = -5; post < 60; ++post) {
        for (const double side : {-7.0, 9.0})
          if (rng.uniform() < 0.3) add({10.0 * post, side}, {0, 0});
      }
      if (rng.uniform() < 0.3) {  // false
        RadarReturn r;
        r.range = rng.uniform(5, 110), r.bearing = rng.uniform(-0.7, 0.7);
        r.range_rate = rng.uniform(-26, 26);
        returns.returns.push_back(r);
      }
      frame.data = returns;
      posterior =
          step(posterior, front_end.extract(frame), model, RngKey{seed, i, 0, 0}, 8).posterior;
      judge(model, posterior, t);
    }
  }

  void judge(const FilterModel& model, const Posterior& posterior, double t) {
    objects = 0;
    std::vector<Vector4> states;
    for (const auto& track : posterior.hypotheses[mapHypothesis(posterior).slot]->tracks) {
      if (track->existence < 0.5) continue;
      const auto best = track->likeliestClass();
      if (best != 0) continue;
      ++objects;
      states.push_back(
          kinematicsOf(model.classes[best], track->bank[std::size_t(best)]).q.head<4>());
    }
    if (t > 1) most_objects = std::max(most_objects, objects);
    worst_position = worst_speed = 0;
    for (const Car& car : cars) {
      double nearest = 1e9, speed = 1e9;
      for (const Vector4& x : states) {
        const double distance = (x.head<2>() - car.at(t)).norm();
        if (distance < nearest) nearest = distance, speed = (x.tail<2>() - car.velocity).norm();
      }
      worst_position = std::max(worst_position, nearest);
      worst_speed = std::max(worst_speed, speed);
    }
  }
};

TEST(RadarAlone, TracksWhatMovesBetweenGuardRails) {
  int extra = 0, missed = 0;
  const int runs = 10;
  for (int seed = 1; seed <= runs; ++seed) {
    Drive drive;
    drive.run(3, static_cast<std::uint64_t>(seed), {});
    extra += drive.objects > 2;
    missed += drive.worst_position > 2 || drive.worst_speed > 1.5;
  }
  EXPECT_LE(extra, 1);
  EXPECT_LE(missed, 1);
}

TEST(RadarAlone, RoughUnitsHardlyTakeRailsForTraffic) {
  // 5 m, 5 deg, 1 m/s among some 25 returns of posts a scan: a bearing 5 deg off is 1 m/s.
  int false_cars = 0;
  for (int seed = 1; seed <= 5; ++seed) {
    Drive drive;
    drive.bearing_sigma = radians(5);
    drive.cars.clear();
    RadarParams duc;
    duc.range_sigma = 5, duc.rate_sigma = 1;
    drive.run(3, static_cast<std::uint64_t>(seed), duc);
    false_cars += drive.most_objects;
  }
  EXPECT_LE(false_cars, 5);  // one in three seconds
}

}  // namespace
}  // namespace perception
