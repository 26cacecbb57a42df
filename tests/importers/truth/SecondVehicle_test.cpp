#include "libperception/importers/truth/SecondVehicle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr double kNorth = 0.7;  // [rad] of east in the world frame

Stamp stampAt(double t) { return Stamp{1'700'000'000'000'000'000 + std::llround(t * 1e9)}; }

/// The own vehicle starts at the origin along x and bends to the left; the other comes towards it.
Pose3 ownAt(double t) { return makePose(10 * t, 0.05 * t * t, 0, std::atan2(0.1 * t, 10)); }
Vector2 otherAt(double t) { return {250 - 11 * t, 4 + 2 * std::sin(0.3 * t)}; }

Vector2 toEarth(const Vector2& world) { return rotate2(-kNorth, world) + Vector2(30, -40); }

/// An encounter of 20 s with receivers at 5 Hz. White noise, and an error of the atmosphere that
/// both receivers share and another of each that changes slowly (10 s).
struct Encounter {
  std::vector<FramePose> poses;
  std::vector<PlaceFix> own, other;

  Encounter(std::uint64_t seed, double white, double slow) {
    Rng rng({seed, 0, 0, 0});
    const Vector2 shared(rng.normal(0, 2), rng.normal(0, 2));
    Vector2 a(rng.normal(0, slow), rng.normal(0, slow)),
        b(rng.normal(0, slow), rng.normal(0, slow));
    const double keep = std::exp(-0.2 / 10), drive = slow * std::sqrt(1 - keep * keep);
    for (int i = 0; i < 200; ++i) poses.push_back({stampAt(0.1 * i), i, ownAt(0.1 * i)});
    for (int i = 0; i < 100; ++i) {
      const double t = 0.2 * i + 0.03;
      const auto noise = [&](double sigma) {
        return Vector2(rng.normal(0, sigma), rng.normal(0, sigma));
      };
      a = keep * a + noise(drive), b = keep * b + noise(drive);
      const Vector2 antenna = (ownAt(t) * Vector3(1, 0, 0)).head<2>();
      own.push_back({stampAt(t), toEarth(antenna) + shared + a + noise(white), 1.5});
      other.push_back({stampAt(t), toEarth(otherAt(t)) + shared + b + noise(white), 1.5});
    }
  }

  /// [m] rms of the truth's places.
  double error() const {
    const auto alignment = alignToWorld(own, Vector2(1, 0), poses);
    double squares = 0;
    const auto rows = truthOfVehicle(other, alignment, {}, poses, stampAt(0));
    for (const TruthObject& o : rows)
      squares += (o.position.head<2>() - otherAt(o.t)).squaredNorm();
    return std::sqrt(squares / static_cast<double>(rows.size()));
  }
};

TEST(SecondVehicle, WithoutNoiseTheTruthIsExact) {
  const Encounter encounter(1, 0, 0);
  const auto alignment = alignToWorld(encounter.own, Vector2(1, 0), encounter.poses);
  EXPECT_NEAR(alignment.yaw, kNorth, 0.002);
  const auto rows = truthOfVehicle(encounter.other, alignment, {}, encounter.poses, stampAt(0));
  ASSERT_GT(rows.size(), 190U);
  EXPECT_EQ(rows.front().frame, 1);  // the first fix is 30 ms after frame 0
  EXPECT_NEAR(rows.front().t, 0.1, 1e-9);
  EXPECT_LT(encounter.error(), 0.1);
  EXPECT_NEAR(rows[100].vx, -11, 0.3);
  EXPECT_NEAR(wrapAngle(rows[100].yaw - kPi), 0, 0.1);
}

TEST(SecondVehicle, TruthOfSimulatedEncountersWithPlainReceiversErrsByAMeter) {
  double squares = 0;
  constexpr int kRuns = 100;
  for (int seed = 0; seed < kRuns; ++seed)
    squares += std::pow(Encounter(static_cast<std::uint64_t>(seed), 0.5, 0.7).error(), 2) / kRuns;
  RecordProperty("rms_m", std::to_string(std::sqrt(squares)));
  std::printf("simulated encounters: truth errs by %.2f m (rms)\n", std::sqrt(squares));
  // Of the slow errors the other's own part and the mean of the own vehicle's remain.
  EXPECT_LT(std::sqrt(squares), 1.6);
  EXPECT_GT(std::sqrt(squares), 0.5);
}

TEST(SecondVehicle, GapOfTheReceiverHasNoTruth) {
  Encounter encounter(1, 0, 0);
  encounter.other.erase(encounter.other.begin() + 20, encounter.other.begin() + 60);
  const auto alignment = alignToWorld(encounter.own, Vector2(1, 0), encounter.poses);
  for (const auto& o : truthOfVehicle(encounter.other, alignment, {}, encounter.poses, stampAt(0)))
    EXPECT_TRUE(o.t < 4 || o.t > 12) << o.t;
}

TEST(SecondVehicle, AntennaBesideTheCenterIsTakenOff) {
  const Encounter encounter(1, 0, 0);
  const auto alignment = alignToWorld(encounter.own, Vector2(1, 0), encounter.poses);
  OtherVehicle vehicle;
  vehicle.antenna = {1.5, 0};
  const auto at_center =
      truthOfVehicle(encounter.other, alignment, {}, encounter.poses, stampAt(0));
  const auto rows =
      truthOfVehicle(encounter.other, alignment, vehicle, encounter.poses, stampAt(0));
  // It drives towards -x: its center lies behind the antenna.
  EXPECT_NEAR(rows[50].position.x() - at_center[50].position.x(), 1.5, 0.05);
}

TEST(SecondVehicle, OwnVehicleThatStandsShowsNoNorth) {
  Encounter encounter(1, 0.5, 0);
  for (auto& pose : encounter.poses) pose.T_world_ego = Pose3::Identity();
  EXPECT_THROW(alignToWorld(encounter.own, Vector2(1, 0), encounter.poses), DataError);
  EXPECT_THROW(alignToWorld({}, Vector2(1, 0), encounter.poses), DataError);
}

}  // namespace
}  // namespace perception
