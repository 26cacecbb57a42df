#include "libperception/pipeline/health/SensorHealth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/models/PositionModel.h"
#include "tests/support/DirtyWindow.h"
#include "tests/support/StartStamp.h"

namespace perception {
namespace {

using test::road;

using test::kStart;
enum HealthPlace : std::size_t { kLidarHealth, kCameraHealth, kRadarHealth };

PipelineSetup::Sensor healthSensor(const char* label, Modality modality) {
  PipelineSetup::Sensor s;
  s.label = label;
  s.params.modality = modality;
  s.active = true;
  return s;
}

LidarCloud everyOf(const LidarCloud& cloud, std::size_t step) {
  LidarCloud some;
  for (std::size_t k = 0; k < cloud.size(); k += step)
    some.x.push_back(cloud.x[k]), some.y.push_back(cloud.y[k]), some.z.push_back(cloud.z[k]);
  return some;
}

/// A lidar, a camera and a radar, all forward, watched at 10 Hz.
struct HealthWatched {
  std::vector<PipelineSetup::Sensor> sensors = {healthSensor("LIDAR", Modality::kLidar),
                                                healthSensor("CAMERA", Modality::kCamera),
                                                healthSensor("RADAR", Modality::kRadar)};
  EventLog events;
  SensorHealth health{sensors, events};

  template <class Data>
  void see(std::size_t place, double t, Data data, double fog = 0, double way = 0) {
    SensorFrame frame;
    frame.stamp = kStart + t;
    frame.ego.T_world_ego.translation().x() = way;
    frame.sensor = sensors[place].label;
    // Cameras look along z of their frame, x to the right.
    if (place == kCameraHealth) frame.T_ego_sensor.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    frame.data = std::move(data);
    health.addFrame(place, frame, fog);
  }
  /// The scan of `place` with what it detects, and a car at `x` [m] ahead that the lidar has just
  /// seen, at `speed` [m/s].
  void scan(std::size_t place, double t, double x, double speed, std::vector<Vector2> detections,
            std::shared_ptr<const ClutterMap> clutter = nullptr) {
    PositionModel::Params params;
    params.classes.resize(1);
    params.classes[0].detection = 0.85;
    params.classes[0].labels = {1};
    params.clutter_labels = {1};
    params.range = 40;
    MeasurementScan scan;
    scan.modality = sensors[place].params.modality;
    scan.model = std::make_shared<const PositionModel>(params);
    scan.state.stamp = kStart + t;
    for (const Vector2& d : detections) {
      Measurement m;
      m.z = m.position = d;
      m.R = 0.01 * Matrix2::Identity();
      m.seen = 3;
      scan.measurements.push_back(m);
    }
    FilterModel model;
    ObjectClass kind;
    kind.motion = findMotionModel("constant-velocity");
    kind.reported = true;
    model.classes.classes = {kind};
    Track car;
    car.id = 1, car.existence = 0.99, car.birth = kStart + (t - 5), car.log_class = {0};
    car.bank.resize(1);
    car.bank[0].x << x, 0, speed, 0;
    car.bank[0].extent.length = 5;
    car.last_hit[modalityIndex(Modality::kLidar)] = scan.state.stamp;
    if (!detections.empty()) car.last_hit[modalityIndex(scan.modality)] = scan.state.stamp;
    if (!clutter) clutter = std::make_shared<const ClutterMap>(sensors[place].params);
    health.addScan(place, scan, Hypothesis({std::make_shared<const Track>(car)}), model, clutter);
  }
  std::size_t count(const char* kind) const {
    const auto found = events.counts().find(kind);
    return found == events.counts().end() ? 0 : found->second;
  }
  std::string text() const { return events.text(kStart); }
};

TEST(SensorHealth, ALidarThatHardlyReturnsAnythingIsBlindWithinTwoSeconds) {
  HealthWatched w;
  for (int k = 0; k < 10; ++k) w.see(kLidarHealth, 0.1 * k, road(0));
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 0U);
  for (int k = 10; k <= 30; ++k) w.see(kLidarHealth, 0.1 * k, LidarCloud());
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 1U);
  EXPECT_NE(w.text().find("\"remaining\":\"CR\""), std::string::npos);
  EXPECT_EQ(w.events.warnings(), 1U);
  w.see(kLidarHealth, 3.1, road(0));
  EXPECT_EQ(w.count(event_kind::kSensorBack), 1U);
}

TEST(SensorHealth, ACameraThatMissesWhatTheLidarSeesIsBlind) {
  HealthWatched w;
  for (int k = 0; k <= 20; ++k) {
    w.see(kCameraHealth, 0.1 * k, ObjectDetections());
    w.scan(kCameraHealth, 0.1 * k, 15, 0, {});
  }
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 1U);
  EXPECT_NE(w.text().find("\"covers_deg\""), std::string::npos);
}

TEST(SensorHealth, NoSensorIsBlindToWhatIsOutOfItsView) {
  HealthWatched w;
  for (int k = 0; k <= 50; ++k) {
    w.see(kCameraHealth, 0.1 * k, ObjectDetections());
    w.scan(kCameraHealth, 0.1 * k, 60, 10, {});
    w.see(kRadarHealth, 0.1 * k, RadarReturns());
    w.scan(kRadarHealth, 0.1 * k, 60, 10, {});
  }
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 0U);
}

TEST(SensorHealth, ARadarIsJudgedByWhatMoves) {
  for (const double speed : {0.0, 10.0}) {
    HealthWatched w;
    for (int k = 0; k <= 20; ++k) {
      w.see(kRadarHealth, 0.1 * k, RadarReturns());
      w.scan(kRadarHealth, 0.1 * k, 15, speed, {});
    }
    EXPECT_EQ(w.count(event_kind::kSensorBlind), speed > 0 ? 1U : 0U);
  }
}

TEST(SensorHealth, ARadarIsNotJudgedByWhatPassesBesideIt) {
  RadarReturns some;
  some.returns.resize(1);  // something else, so that it is not silent
  for (const double x : {4.0, 15.0}) {
    HealthWatched w;
    for (int k = 0; k <= 20; ++k) {
      w.see(kRadarHealth, 0.1 * k, some);
      w.scan(kRadarHealth, 0.1 * k, x, 10, {});
    }
    EXPECT_EQ(w.count(event_kind::kSensorFouled), x > 5 ? 1U : 0U);
  }
}

TEST(SensorHealth, ARadarWithoutItsUsualClutterIsBlind) {
  const auto named = [](double configured, double usual) {
    HealthWatched w;
    w.sensors[kRadarHealth].params.clutter_per_scan = configured;
    auto clutter = std::make_shared<ClutterMap>(w.sensors[kRadarHealth].params);
    for (int k = 0; k < 100; ++k) {
      std::vector<double> counts(clutter->cells().size(), 0);
      counts[0] = usual;
      clutter->add(counts, 0.1);
    }
    for (int k = 0; k <= 20; ++k) {
      w.see(kRadarHealth, 0.1 * k, RadarReturns());
      w.scan(kRadarHealth, 0.1 * k, 60, 0, {}, clutter);
    }
    return w.count(event_kind::kSensorBlind);
  };
  EXPECT_EQ(named(1, 1), 1U);
  EXPECT_EQ(named(1, 0), 0U);
  EXPECT_EQ(named(0.1, 1), 0U) << "what exceeds the configured rate stands there and may go";
}

TEST(SensorHealth, ACameraThatSeesAThirdOfWhatItShouldIsFouledAndAHealthyOneIsNot) {
  for (const double share : {0.3, 0.85}) {
    HealthWatched w;
    Rng rng({5, 0, 0, 0});
    for (int k = 0; k <= 100; ++k) {
      ObjectDetections some;
      some.objects.resize(1);  // something else, so that it is not silent
      w.see(kCameraHealth, 0.1 * k, some);
      const bool seen = rng.uniform() < share;
      w.scan(kCameraHealth, 0.1 * k, 15, 0,
             seen ? std::vector<Vector2>{{15, 0}} : std::vector<Vector2>{});
    }
    EXPECT_EQ(w.count(event_kind::kSensorFouled), share < 0.5 ? 1U : 0U);
  }
}

TEST(SensorHealth, ASensorWhoseBearingsAreAllOffIsMisaligned) {
  for (const double off : {0.0, radians(5)}) {
    HealthWatched w;
    for (int k = 0; k <= 30; ++k) {
      ObjectDetections some;
      some.objects.resize(1);
      w.see(kCameraHealth, 0.1 * k, some);
      const double noise = radians(k % 3 - 1.0);
      w.scan(kCameraHealth, 0.1 * k, 15, 0,
             {{15 * std::cos(off + noise), 15 * std::sin(off + noise)}});
    }
    EXPECT_EQ(w.count(event_kind::kSensorMisaligned), off > 0 ? 1U : 0U);
  }
}

TEST(SensorHealth, DirtOnAWindowIsNamedWithinTwoSeconds) {
  HealthWatched w;
  for (int k = 0; k <= 20; ++k) w.see(kLidarHealth, 0.1 * k, road(0.2));
  EXPECT_EQ(w.count(event_kind::kSensorFouled), 1U);
}

TEST(SensorHealth, ACleanWindowAndDirtInFogAreNotNamed) {
  HealthWatched clean, fog;
  for (int k = 0; k <= 30; ++k) clean.see(kLidarHealth, 0.1 * k, road(0));
  for (int k = 0; k <= 30; ++k) fog.see(kLidarHealth, 0.1 * k, road(0.2), 0.9);
  EXPECT_TRUE(clean.events.counts().empty());
  EXPECT_TRUE(fog.events.counts().empty());
}

TEST(SensorHealth, ALidarOfWhichATenthIsLeftOfTheRoadIsFouledWithinTwoSeconds) {
  HealthWatched w;
  for (int k = 0; k < 30; ++k) w.see(kLidarHealth, 0.1 * k, road(0));
  EXPECT_TRUE(w.events.counts().empty());
  for (int k = 30; k < 50; ++k) w.see(kLidarHealth, 0.1 * k, everyOf(road(0), 10));
  EXPECT_EQ(w.count(event_kind::kSensorFouled), 1U);
}

TEST(SensorHealth, ARadarThatNoLongerSeesAStandingObjectThatItSawIsBlind) {
  for (const bool seen : {false, true}) {
    HealthWatched w;
    for (int k = 0; k < 30; ++k) {
      RadarReturns some;
      some.returns.resize(1);
      w.see(kRadarHealth, 0.1 * k, some);
      w.scan(kRadarHealth, 0.1 * k, 15, 0,
             seen ? std::vector<Vector2>{{15, 0}} : std::vector<Vector2>{});
    }
    for (int k = 30; k < 50; ++k) {
      w.see(kRadarHealth, 0.1 * k, RadarReturns());
      w.scan(kRadarHealth, 0.1 * k, 15, 0, {});
    }
    EXPECT_EQ(w.count(event_kind::kSensorBlind), seen ? 1U : 0U);
  }
}

TEST(SensorHealth, ASensorThatRepeatsItsLastFrameOnTheWayIsBlindUntilItsPictureChanges) {
  HealthWatched w;
  RadarReturns some;
  some.returns.emplace_back().range = 20;
  for (int k = 0; k <= 12; ++k) w.see(kRadarHealth, 0.1 * k, some, 0, k);
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 1U);
  some.returns[0].range = 21;
  w.see(kRadarHealth, 1.3, some, 0, 13);
  EXPECT_EQ(w.count(event_kind::kSensorBack), 1U);
}

TEST(SensorHealth, AScannerOfAMergedLidarIsNamedByItself) {
  HealthWatched w;
  for (int k = 0; k < 30; ++k) {
    SensorFrame part;
    part.stamp = kStart + 0.1 * k;
    part.sensor = "LIDAR_LEFT";
    part.data = k < 10 ? road(0) : LidarCloud();
    w.health.addPart(kLidarHealth, part);
    w.see(kLidarHealth, 0.1 * k, road(0));
  }
  EXPECT_EQ(w.count(event_kind::kSensorBlind), 1U);
  EXPECT_NE(w.text().find("\"sensor\":\"LIDAR_LEFT\""), std::string::npos);
}

}  // namespace
}  // namespace perception
