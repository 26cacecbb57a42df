// The vehicle's pose from simulated satellites, inertial unit and wheels: errors against the truth
// stay inside the filter's own covariance, also where no satellite is.
#include "libperception/sensors/ego/EgoFusion.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationGPS.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "libperception/core/math/Chi2.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/simulation/EgoSensors.h"
#include "libperception/simulation/world/Trajectory.h"

namespace perception {
namespace {

using Observation = std::shared_ptr<mrpt::obs::CObservation>;

constexpr Stamp kStart{1'577'836'800'000'000'000};
constexpr double kDuration = 70;              // [s]
constexpr double kGapFrom = 35, kGapTo = 45;  // [s] no satellites
const Geodetic kOrigin{42.4440, -76.5019, 250};

/// A minute through a town: straight, left, right, a stop at 27 to 31 s, a left bend in the gap.
/// Straight before and after the stop: nothing turns on the spot.
const Trajectory& way() {
  static const Trajectory trajectory(
      {0, 5, 10, 13, 18, 19.5, 22, 27, 31, 35, 40, 44, 48, 54, 60, 66, 80},
      {0, 30, 80, 103, 115, 118, 130, 150, 150, 165, 200, 215, 215, 195, 145, 95, -20},
      {0, 0, 0, 10, 45, 55, 70, 70, 70, 70, 74, 100, 135, 165, 172, 172, 172}, 0);
  return trajectory;
}

EgoTruth truth() {
  return {[](double t) {
            const Motion2 m = way().at(t);
            EgoState state;
            state.stamp = kStart + t;
            state.T_world_ego = makePose(m.position.x(), m.position.y(), 0, m.heading);
            state.velocity = m.velocity;
            state.yaw_rate = m.yaw_rate;
            return state;
          },
          [](double t) { return kStart + t; }};
}

struct Drive {
  GnssUnitParams gnss;
  bool satellites = true, imu = true, wheels = true;
  double gnss_rate = 10;
};

std::vector<Observation> observations(const Drive& drive, std::uint64_t seed) {
  std::vector<Observation> all;
  const EgoTruth t = truth();
  const auto put = [&](double rate, const auto& make) {
    for (std::uint64_t k = 0; static_cast<double>(k) / rate <= kDuration; ++k) {
      if (auto o = make(static_cast<double>(k) / rate, k)) all.push_back(o);
    }
  };
  const EgoMount antenna{"GNSS", makePose(0.5, 0.2, 1.8, 0), drive.gnss_rate};
  const EgoMount unit{"IMU", makePose(0.3, -0.1, 0.6, 0.2, 0.05, -0.03), 100};
  const EgoMount axle{"WHEELS", Pose3::Identity(), 50};
  if (drive.satellites)
    put(antenna.rate, [&](double at, std::uint64_t k) {
      return gnssObservation(drive.gnss, antenna, t, at, {seed, k, 0, 1});
    });
  if (drive.imu)
    put(unit.rate, [&](double at, std::uint64_t k) {
      return imuObservation({}, unit, t, at, {seed, k, 0, 2});
    });
  if (drive.wheels)
    put(axle.rate, [&](double at, std::uint64_t k) {
      return wheelObservation({}, axle, t, at, {seed, k, 0, 3});
    });
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a->timestamp < b->timestamp; });
  return all;
}

Drive withGap(double gnss_rate) {
  Drive drive;
  drive.gnss.gap_from = {kGapFrom}, drive.gnss.gap_to = {kGapTo};
  drive.gnss_rate = gnss_rate;
  return drive;
}

FusionParams params() {
  FusionParams p;
  p.origin = {kOrigin.latitude, kOrigin.longitude, kOrigin.height};
  return p;
}

/// Error of (x, y, yaw) against the truth and their covariance.
struct Look {
  double t = 0;
  Vector3 error;
  Eigen::Matrix3d P;
  double pitch = 0, roll = 0, pitch_sigma = 0, roll_sigma = 0, speed = 0;
  double nees() const { return error.dot(P.ldlt().solve(error)); }
};

Look lookAt(const EgoFusion& fusion) {
  const EgoMotionState& s = fusion.state();
  Look look;
  look.t = s.stamp - kStart;
  const EgoState real = truth().at(look.t);
  const EgoVector& x = s.estimate.x;
  look.error << x[kEgoX] - real.T_world_ego.translation().x(),
      x[kEgoY] - real.T_world_ego.translation().y(),
      wrapAngle(x[kEgoYaw] - yawOf(real.T_world_ego));
  const std::array<int, 3> axes = {kEgoX, kEgoY, kEgoYaw};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      look.P(static_cast<int>(i), static_cast<int>(j)) = s.estimate.P(axes[i], axes[j]);
  look.pitch = x[kEgoPitch], look.roll = x[kEgoRoll], look.speed = x[kEgoSpeed];
  look.pitch_sigma = std::sqrt(s.estimate.P(kEgoPitch, kEgoPitch));
  look.roll_sigma = std::sqrt(s.estimate.P(kEgoRoll, kEgoRoll));
  return look;
}

/// Looks once a second from 10 s on.
std::vector<Look> run(const Drive& drive, std::uint64_t seed) {
  EgoFusion fusion(params());
  std::vector<Look> looks;
  double next = 10;
  for (const auto& o : observations(drive, seed)) {
    const double t = *toStamp(o->timestamp) - kStart;
    if (t > next + 1e-6) {
      looks.push_back(lookAt(fusion));
      next += 1;
    }
    fusion.add(*o);
  }
  EXPECT_TRUE(fusion.state().heading_known);
  EXPECT_EQ(fusion.late(), 0U);
  return looks;
}

class EgoFusionRate : public ::testing::TestWithParam<double> {};

// The mean over N independent runs of the NEES of three axes is chi-square with 3 N degrees of
// freedom over N: at every second it must be inside the two-sided 99.9 % interval, gap included.
TEST_P(EgoFusionRate, ErrorsStayInsideTheCovarianceThroughTheGap) {
  constexpr int kRuns = 20;
  std::vector<double> nees;
  int outside = 0, count = 0;
  double worst_position = 0, worst_yaw = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const auto looks = run(withGap(GetParam()), static_cast<std::uint64_t>(seed));
    nees.resize(looks.size());
    for (std::size_t i = 0; i < looks.size(); ++i) {
      nees[i] += looks[i].nees() / kRuns;
      for (int axis = 0; axis < 3; ++axis) {
        outside += std::abs(looks[i].error[axis]) > 3 * std::sqrt(looks[i].P(axis, axis));
        ++count;
      }
      if (looks[i].t < kGapFrom || looks[i].t > kGapTo + 0.5) continue;
      worst_position = std::max(worst_position, looks[i].error.head<2>().norm());
      worst_yaw = std::max(worst_yaw, std::abs(looks[i].error[2]));
    }
  }
  const double low = chi2Quantile(0.0005, 3 * kRuns) / kRuns;
  const double high = chi2Quantile(0.9995, 3 * kRuns) / kRuns;
  double mean = 0;
  int beyond = 0;
  for (const double value : nees) {
    mean += value / static_cast<double>(nees.size());
    beyond += value < low || value > high;
  }
  std::printf(
      "GNSS %.0f Hz: mean NEES %.2f of 3 (one second: %.2f to %.2f, %d of %zu beyond), "
      "%.2f %% beyond 3 sigma, in the gap at most %.2f m, %.2f deg\n",
      GetParam(), mean, low, high, beyond, nees.size(), 100. * outside / count, worst_position,
      degrees(worst_yaw));
  // Seconds of a run are not independent: one of them may lie just beyond.
  EXPECT_LE(beyond, 1);
  // Beyond 3 sigma: 0.27 % of a Gaussian; the filter is allowed ten times that.
  EXPECT_LT(outside, 0.027 * count);
  EXPECT_LT(worst_position, 8);
}

INSTANTIATE_TEST_SUITE_P(Rates, EgoFusionRate, ::testing::Values(1.0, 10.0));

TEST(EgoFusion, OrderOfArrivalDoesNotMatter) {
  Drive drive = withGap(5);
  auto sorted = observations(drive, 3);
  sorted.resize(sorted.size() / 3);
  auto shuffled = sorted;
  // Fixes come 0.3 s late, wheels 0.05 s.
  const auto arrival = [](const Observation& o) {
    const double t = *toStamp(o->timestamp) - kStart;
    return t + (o->sensorLabel == "GNSS" ? 0.3 : o->sensorLabel == "WHEELS" ? 0.05 : 0);
  };
  std::stable_sort(shuffled.begin(), shuffled.end(),
                   [&](const auto& a, const auto& b) { return arrival(a) < arrival(b); });
  EgoFusion a(params()), b(params());
  for (const auto& o : sorted) a.add(*o);
  for (const auto& o : shuffled) b.add(*o);
  EXPECT_EQ(b.late(), 0U);
  EXPECT_EQ(a.state().estimate.x, b.state().estimate.x);
  EXPECT_EQ(a.state().estimate.P, b.state().estimate.P);
  ASSERT_EQ(a.poses().size(), b.poses().size());
  for (std::size_t i = 0; i < a.poses().size(); ++i) {
    EXPECT_EQ(a.poses()[i].stamp, b.poses()[i].stamp);
    EXPECT_TRUE(a.poses()[i].T_world_ego.isApprox(b.poses()[i].T_world_ego, 1e-12));
  }
}

TEST(EgoFusion, WithoutWheelsOrWithoutInertialUnitItIsConsistent) {
  for (const bool imu : {true, false}) {
    double nees = 0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Drive drive;
      drive.imu = imu, drive.wheels = !imu;
      for (const Look& look : run(drive, seed)) {
        nees += look.nees();
        ++count;
      }
    }
    // Models that must cover whatever a vehicle does are wider than needed: half is still right.
    EXPECT_GT(nees / count, 1) << (imu ? "gyros" : "wheels");
    EXPECT_LT(nees / count, 4.5) << (imu ? "gyros" : "wheels");
  }
}

TEST(EgoFusion, SatellitesAloneFollowTheWay) {
  Drive drive;
  drive.imu = drive.wheels = false;
  std::vector<double> errors;
  for (const Look& look : run(drive, 1)) errors.push_back(look.error.head<2>().norm());
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                   errors.end());
  EXPECT_LT(errors[errors.size() / 2], 1.5);
}

TEST(EgoFusion, PitchAndRollOfALevelRoadAreLevelWithinTheirDeviation) {
  for (const Look& look : run(withGap(10), 5)) {
    EXPECT_LT(std::abs(look.pitch), 4 * look.pitch_sigma);
    EXPECT_LT(std::abs(look.roll), 4 * look.roll_sigma);
    EXPECT_LT(look.pitch_sigma, radians(1.5));
    EXPECT_LT(look.roll_sigma, radians(1.5));
  }
}

TEST(EgoFusion, HeadingIsFoundOnTheWayAndThePastIsTurnedIntoTheWorld) {
  Drive drive;
  drive.gnss.velocity = false;  // no course: from the way alone
  EgoPoseParams pose_params;
  pose_params.fusion = params();
  EgoPose ego(pose_params);
  double found = -1;
  for (const auto& o : observations(drive, 2)) {
    ego.add(*o);
    const double t = *toStamp(o->timestamp) - kStart;
    if (found < 0 && ego.fusion().state().heading_known) {
      found = t;
      EXPECT_EQ(ego.frameEpoch(), 1U);
      break;
    }
  }
  ASSERT_GT(found, 0);
  EXPECT_LT(found, 5);
  for (double t = 0.5; t < found; t += 0.5) {
    const auto state = ego.at(kStart + t);
    ASSERT_TRUE(state);
    const EgoState real = truth().at(t);
    EXPECT_LT((state->T_world_ego.translation() - real.T_world_ego.translation()).head<2>().norm(),
              6);
    EXPECT_NEAR(wrapAngle(yawOf(state->T_world_ego) - yawOf(real.T_world_ego)), 0, radians(25));
  }
}

TEST(EgoFusion, AHeadingThatComesTooLateLeavesTheWorldAsItWas) {
  Drive drive = withGap(10);
  drive.gnss.gap_from = {0}, drive.gnss.gap_to = {20};  // out of a garage
  EgoFusion fusion(params());
  Vector3 before = Vector3::Zero();
  for (const auto& o : observations(drive, 4)) {
    if (!fusion.state().heading_known) before = fusion.state().estimate.x.head<3>();
    const bool searching = !fusion.state().heading_known;
    fusion.add(*o);
    if (searching && fusion.state().heading_known) {
      EXPECT_LT((fusion.state().estimate.x.head<3>() - before).norm(), 1);  // no jump
    }
  }
  EXPECT_EQ(fusion.state().relocations, 0U);
  // Fixes are turned into the world of the start: back in east, north, up the end is right.
  const EgoMotionState& s = fusion.state();
  const Vector3 world = s.estimate.x.head<3>();
  Vector2 enu = rotate2(s.world_turn, world.head<2>()) + s.world_shift.head<2>();
  const EgoState real = truth().at(s.stamp - kStart);
  EXPECT_LT((enu - real.T_world_ego.translation().head<2>()).norm(), 6);
}

TEST(EgoFusion, WildFixesAreRejectedAndANewPlaceIsBelievedAfterAWhile) {
  const auto all = observations(Drive(), 6);
  EgoFusion fusion(params());
  const LocalFrame frame(kOrigin);
  double shift = 0;
  for (const auto& o : all) {
    const double t = *toStamp(o->timestamp) - kStart;
    if (t > 30) break;
    auto copy = o;
    if (const auto gps = std::dynamic_pointer_cast<mrpt::obs::CObservationGPS>(o)) {
      shift = (t > 15 && t < 15.5) ? 80 : t > 22 ? 60 : 0;  // a reflection; another place
      auto moved = std::make_shared<mrpt::obs::CObservationGPS>(*gps);
      auto& gga = moved->getMsgByClass<mrpt::obs::gnss::Message_NMEA_GGA>().fields;
      const Vector3 enu =
          frame.fromGeodetic({gga.latitude_degrees, gga.longitude_degrees, gga.altitude_meters});
      const Geodetic place = frame.toGeodetic(enu + Vector3(0, shift, 0));
      gga.latitude_degrees = place.latitude, gga.longitude_degrees = place.longitude;
      copy = moved;
    }
    fusion.add(*copy);
    if (std::abs(t - 15.45) < 1e-6) {
      EXPECT_GE(fusion.state().rejected_fixes, 4U);
      EXPECT_LT(lookAt(fusion).error.head<2>().norm(), 4);
    }
  }
  const Look look = lookAt(fusion);
  EXPECT_NEAR(look.error.y(), 60, 4);
  EXPECT_NEAR(look.error.x(), 0, 4);
}

TEST(EgoFusion, WheelsAloneAreTheWayFromTheStart) {
  Drive drive;
  drive.satellites = drive.imu = false;
  EgoPose ego;
  for (const auto& o : observations(drive, 1)) ego.add(*o);
  EXPECT_FALSE(ego.empty());
  EXPECT_FALSE(ego.fusion().state().heading_known);
  const EgoState start = truth().at(0);
  const auto end = ego.at(kStart + 65);
  ASSERT_TRUE(end);
  const Pose3 real = start.T_world_ego.inverse() * truth().at(65).T_world_ego;
  EXPECT_LT((end->T_world_ego.translation() - real.translation()).head<2>().norm(), 30);
  EXPECT_GT(end->uncertainty.sigma_xy, 1);
}

TEST(EgoFusion, ReadingsThatAreTooLateOrNoneAreCounted) {
  EgoFusion fusion(params());
  const auto all = observations(Drive(), 1);
  const auto early = all[3];
  for (std::size_t i = 10; i < all.size() / 4; ++i) fusion.add(*all[i]);
  EXPECT_FALSE(fusion.add(*early));
  EXPECT_EQ(fusion.late(), 1U);
  mrpt::obs::CObservationGPS nothing;
  nothing.timestamp = all.back()->timestamp;
  EXPECT_FALSE(fusion.add(nothing));
  EXPECT_EQ(fusion.unusable(), 1U);
}

}  // namespace
}  // namespace perception
