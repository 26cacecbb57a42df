#include "libperception/filter/update/Smoothing.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

constexpr double kStep = 0.1;  // [s] between scans

/// A track through scans, each state linked to the one before and kept.
struct History {
  std::shared_ptr<const PositionModel> sensor =
      std::make_shared<const PositionModel>(linearSensor());
  FilterModel model = exactModel(linearClasses());
  std::vector<TrackHandle> states;

  Track& add(Track&& t) {
    const auto handle = std::make_shared<Track>(std::move(t));
    if (!states.empty()) handle->previous = states.back();
    states.push_back(handle);
    return *handle;
  }
  Track& start(double x, double y) {
    const auto scan = positionScan(sensor, 0, {{x, y, 0}});
    return add(newTrack(likelihoodTable({}, scan, model).births[0], 0, scan, 0, model));
  }
  Track predicted(Stamp to) const { return predictTrack(*states.back(), to, model); }
  Track& hit(double t, double x, double y) {
    const auto scan = positionScan(sensor, t, {{x, y, 0}});
    const Track before = predicted(scan.state.stamp);
    const auto table = likelihoodTable({before}, scan, model);
    return add(
        hitTrack(before, table.tracks[0], table.tracks[0].pairs.at(0), scan, states.size(), model));
  }
  Track& miss(double t) {
    const auto scan = positionScan(sensor, t, {});
    const Track before = predicted(scan.state.stamp);
    return add(missTrack(before, likelihoodTable({before}, scan, model).tracks[0], scan, model));
  }
  Track smoothed(double t) const {
    return smoothedTrack(*states.back(), Stamp::fromSeconds(1000 + t), model).value();
  }
};

/// Positions of a walker who is seen at x = 1.2 t with errors that alternate.
Vector2 seenAt(int k) { return {1 + 0.12 * k + (k % 2 ? 0.15 : -0.1), 2 + (k % 3 ? -0.05 : 0.12)}; }

/// White acceleration of the power spectral density q over dt (method.md 3.1).
Matrix4 noise(double q, double dt) {
  Matrix4 Q = Matrix4::Zero();
  for (int i = 0; i < 2; ++i) {
    Q(i, i) = q * dt * dt * dt / 3;
    Q(i, i + 2) = Q(i + 2, i) = q * dt * dt / 2;
    Q(i + 2, i + 2) = q * dt;
  }
  return Q;
}

/// Means and covariances of all states of a linear chain given all measurements, by one set of
/// normal equations.
struct Batch {
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;

  explicit Batch(int states)
      : information(Eigen::MatrixXd::Zero(4 * states, 4 * states)),
        vector(Eigen::VectorXd::Zero(4 * states)) {}
  void prior(const Vector4& x, const Matrix4& P) {
    information.topLeftCorner<4, 4>() += P.inverse();
    vector.head<4>() += P.inverse() * x;
  }
  void motion(int k, double q, double dt) {  // from state k to k + 1
    Matrix4 F = Matrix4::Identity();
    F(0, 2) = F(1, 3) = dt;
    Eigen::Matrix<double, 4, 8> J;
    J << -F, Matrix4::Identity();
    information.block<8, 8>(4 * k, 4 * k) += J.transpose() * noise(q, dt).inverse() * J;
  }
  void seen(int k, const Vector2& z, double variance) {
    information.block<2, 2>(4 * k, 4 * k) += Matrix2::Identity() / variance;
    vector.segment<2>(4 * k) += z / variance;
  }
  Vector4 mean(int k) const { return (information.inverse() * vector).segment<4>(4 * k); }
  Matrix4 covariance(int k) const { return information.inverse().block<4, 4>(4 * k, 4 * k); }
};

TEST(Smoothing, IsThePosteriorGivenAllMeasurementsForALinearClass) {
  History h;
  h.start(seenAt(0).x(), seenAt(0).y());
  constexpr int kScans = 8;
  const ClassFilter& first = h.states[0]->bank[0];
  const double q = h.model.classes[0].accel_psd, variance = 0.04 + 1e-4 + 1e-9;
  // One more state at 0.33 s, between the scans 3 and 4.
  Batch batch(kScans + 1);
  batch.prior(first.x, first.P);
  for (int k = 1; k < kScans; ++k) {
    h.hit(kStep * k, seenAt(k).x(), seenAt(k).y());
    const int state = k <= 3 ? k : k + 1;
    batch.seen(state, seenAt(k), variance);
    if (k == 4) {
      batch.motion(3, q, 0.03);
      batch.motion(4, q, 0.07);
    } else {
      batch.motion(state - 1, q, kStep);
    }
  }
  for (const auto& [state, t] : std::vector<std::pair<int, double>>{
           {0, 0.0}, {2, 0.2}, {3, 0.3}, {4, 0.33}, {5, 0.4}, {8, 0.7}}) {
    const Track s = h.smoothed(t);
    EXPECT_LT((s.bank[0].x - batch.mean(state)).norm(), 1e-7) << t;
    EXPECT_LT((s.bank[0].P - batch.covariance(state)).norm(), 1e-7) << t;
    EXPECT_EQ(s.stamp, Stamp::fromSeconds(1000 + t));
  }
}

TEST(Smoothing, AStandingObjectIsWhereItIsNow) {
  History h;
  h.start(1, 2);
  for (int k = 1; k < 6; ++k) h.hit(kStep * k, 1 + 0.01 * (k % 2), 2);
  const double q = h.model.classes[1].position_psd;
  // A random walk back over dt, exactly: gain P / (P + q dt).
  const auto& last = h.states[5]->bank[1];
  const auto& before = h.states[4]->bank[1];
  const double gain = before.P(0, 0) / (before.P(0, 0) + q * kStep);
  EXPECT_NEAR(h.smoothed(0.4).bank[1].x[0], before.x[0] + gain * (last.x[0] - before.x[0]), 1e-8);
  EXPECT_EQ(h.smoothed(0.4).bank[1].x[2], 0);
}

TEST(Smoothing, WhatIsThereLaterWasThereBefore) {
  History h;
  h.start(1, 2);
  h.miss(0.1);
  h.hit(0.2, 1, 2);
  EXPECT_LT(h.states[1]->existence, 0.5);
  EXPECT_NEAR(h.smoothed(0.1).existence, 1, 1e-12);
  EXPECT_FALSE(smoothedTrack(*h.states.back(), Stamp::fromSeconds(999.9), h.model));
}

TEST(Smoothing, DetectionsThatCameLaterCountForTheClass) {
  History h;
  Track& first = h.start(1, 2);
  first.hits = {}, first.missed = 1;  // one of two looks, the free one
  Track& last = h.hit(0.1, 1, 2);
  last.hits = {}, last.hits[0] = 7, last.missed = 0;
  EXPECT_DOUBLE_EQ(h.states[0]->shareOfEvidence(), 0.5);
  EXPECT_EQ(h.smoothed(0).shareOfEvidence(), 1);
}

TEST(Smoothing, WhatIsNotSeenAgainIsLessSureInTheScansThatShowedIt) {
  History h;
  h.start(1, 2).hits = {};
  Track& last = h.miss(0.1);
  last.hits = {}, last.missed = 1;
  EXPECT_EQ(h.states[0]->shareOfEvidence(), 1);
  EXPECT_DOUBLE_EQ(h.smoothed(0).shareOfEvidence(), 0.5);
}

TEST(Smoothing, ExistenceIsThatOfTheTwoStateChain) {
  History h;
  h.start(1, 2);
  const double r0 = h.states[0]->existence;
  h.miss(0.1);
  h.miss(0.2);
  const double S = std::exp(-kStep / 20);
  // By enumeration: it ended before the first miss, before the second one, or never.
  const auto detection = [&](int k) {
    const Track before = predictTrack(*h.states[static_cast<std::size_t>(k - 1)],
                                      h.states[static_cast<std::size_t>(k)]->stamp, h.model);
    return likelihoodTable({before}, positionScan(h.sensor, kStep * k, {}), h.model)
        .tracks[0]
        .detection;
  };
  const double d1 = detection(1), d2 = detection(2);
  const double never = r0 * S * (1 - d1) * S * (1 - d2), after_one = r0 * S * (1 - d1) * (1 - S),
               at_once = r0 * (1 - S);
  const double all = never + after_one + at_once + (1 - r0);
  EXPECT_NEAR(h.smoothed(0.2).existence, never / all, 1e-12);
  EXPECT_NEAR(h.smoothed(0.1).existence, (never + after_one) / all, 1e-12);
  EXPECT_NEAR(h.smoothed(0.0).existence, (never + after_one + at_once) / all, 1e-12);
}

TEST(Smoothing, WithoutForgettingTheClassIsTheOneKnownNow) {
  History h;
  h.start(1, 2);
  for (int k = 1; k < 6; ++k) h.hit(kStep * k, 1 + 0.15 * k, 2);
  EXPECT_NEAR(h.smoothed(0).log_class[0], h.states.back()->log_class[0], 1e-9);
  EXPECT_GT(h.smoothed(0).log_class[0], h.states[0]->log_class[0] + 0.1);
}

TEST(Smoothing, AClassThatMayHaveChangedIsForgottenBackwards) {
  History h;
  h.model.params.class_forgetting = 0.2;
  h.start(1, 2);
  h.hit(0.1, 1.05, 2);
  const auto p0 = classProbabilities(*h.states[0]), p1 = classProbabilities(*h.states[1]);
  const double g = 1 - std::exp(-kStep / 0.2);
  const auto chain = [&](std::size_t from, std::size_t to) {
    return (from == to ? 1 - g : 0) + g / 2;
  };
  double joint[2] = {0, 0};
  for (std::size_t from = 0; from < 2; ++from) {
    for (std::size_t to = 0; to < 2; ++to)
      joint[from] +=
          p0[from] * chain(from, to) * p1[to] / (p0[0] * chain(0, to) + p0[1] * chain(1, to));
  }
  EXPECT_NEAR(classProbabilities(h.smoothed(0))[0], joint[0] / (joint[0] + joint[1]), 1e-12);
}

/// A car that turns, seen as noisy positions: motion without heading first.
struct Drive {
  History h;
  std::vector<Vector2> velocity;  // [m/s] true, by scan
  std::vector<double> heading;    // [rad] true

  explicit Drive(std::uint64_t seed) {
    auto& car = h.model.classes.classes[0];
    car.motion = findMotionModel("wheeled");
    car.accel_psd = 1;
    car.position_psd = 0.01;
    car.max_speed = 40;
    Rng rng({seed, 0, 0, 0x5300});
    Vector2 p(0, 0);
    double yaw = 0.3;
    for (int k = 0; k < 40; ++k) {
      const Vector2 z = p + 0.2 * Vector2(rng.normal(), rng.normal());
      k == 0 ? h.start(z.x(), z.y()) : h.hit(kStep * k, z.x(), z.y());
      velocity.push_back(6 * Vector2(std::cos(yaw), std::sin(yaw)));
      heading.push_back(yaw);
      p += kStep * velocity.back();
      yaw += 0.05 * rng.normal() + 0.02;
    }
  }
};

TEST(Smoothing, HalfASecondMakesACarsVelocityAndHeadingAFifthBetter) {
  double filtered_v = 0, smoothed_v = 0, filtered_yaw = 0, smoothed_yaw = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drive drive(seed);
    for (std::size_t k = 10; k + 5 < drive.h.states.size(); ++k) {
      const Track& now = *drive.h.states[k];
      const Track later = smoothedTrack(*drive.h.states[k + 5], now.stamp, drive.h.model).value();
      ASSERT_TRUE(now.bank[0].oriented && later.bank[0].oriented);
      const auto v_error = [&](const Track& t) {
        const Kinematics q = kinematicsOf(drive.h.model.classes[0], t.bank[0]);
        return (q.q.segment<2>(2) - drive.velocity[k]).squaredNorm();
      };
      const auto yaw_error = [&](const Track& t) {
        return std::pow(wrapAngle(t.bank[0].x[3] - drive.heading[k]), 2);
      };
      filtered_v += v_error(now), smoothed_v += v_error(later);
      filtered_yaw += yaw_error(now), smoothed_yaw += yaw_error(later);
    }
  }
  EXPECT_LT(std::sqrt(smoothed_v), 0.8 * std::sqrt(filtered_v));
  EXPECT_LT(std::sqrt(smoothed_yaw), 0.8 * std::sqrt(filtered_yaw));
}

TEST(Smoothing, AHeadingFoundLaterHoldsForBefore) {
  const Drive drive(3);
  ASSERT_FALSE(drive.h.states[0]->bank[0].oriented);
  const Track first = drive.h.smoothed(0);
  EXPECT_TRUE(first.bank[0].oriented);
  EXPECT_LT(std::abs(wrapAngle(first.bank[0].x[3] - drive.heading[0])), 0.4);
}

TEST(Smoothing, TheHistoryEndsWhereNobodyKeepsIt) {
  History h;
  h.start(1, 2);
  for (int k = 1; k < 6; ++k) h.hit(kStep * k, 1 + 0.1 * k, 2);
  const TrackHandle last = h.states.back();
  h.states.erase(h.states.begin(), h.states.begin() + 3);
  const auto oldest = smoothedTrack(*last, Stamp::fromSeconds(1000), h.model);
  ASSERT_TRUE(oldest);
  EXPECT_EQ(oldest->stamp, Stamp::fromSeconds(1000.3));
}

}  // namespace
}  // namespace perception
