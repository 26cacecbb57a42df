#include "libperception/filter/state/BankBatch.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "libperception/core/math/Random.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

constexpr std::size_t kSize = 37;  // not a multiple of any vector

std::vector<SimdLevel> levels() {
  std::vector<SimdLevel> out;
  for (const auto l : {SimdLevel::kSse2, SimdLevel::kAvx2, SimdLevel::kAvx512})
    if (l <= simdLevel()) out.push_back(l);
  return out;
}

ClassFilter randomFilter(Rng& rng, bool oriented) {
  ClassFilter f;
  Matrix4 A;
  for (int i = 0; i < 16; ++i) A(i / 4, i % 4) = rng.normal();
  f.P = 0.1 * A * A.transpose() + 0.05 * Matrix4::Identity();
  if (oriented) {  // a heading sure enough for batches (BatchKernel::kWheeled)
    f.P.row(3) *= 0.05, f.P.col(3) *= 0.05;
  }
  f.x << rng.normal(0, 20), rng.normal(0, 20), rng.normal(0, 5), rng.uniform(-3, 3);
  f.oriented = oriented;
  return f;
}

void put(const ClassFilter& f, std::size_t i, BankBatch& bank) {
  std::size_t plane = 4;
  for (int r = 0; r < 4; ++r) {
    bank[static_cast<std::size_t>(r)][i] = f.x[r];
    for (int c = r; c < 4; ++c) bank[plane++][i] = f.P(r, c);
  }
}

void expectEqual(const Vector4& x, const Matrix4& P, const BankBatch& bank, std::size_t i) {
  std::size_t plane = 4;
  for (int r = 0; r < 4; ++r) {
    EXPECT_NEAR(bank[static_cast<std::size_t>(r)][i], x[r], 1e-9 * (1 + std::abs(x[r])));
    for (int c = r; c < 4; ++c)
      EXPECT_NEAR(bank[plane++][i], P(r, c), 1e-9 * (1 + P.norm())) << r << ", " << c;
  }
}

TEST(BankBatch, PredictsAsTheScalarModels) {
  ObjectClass walker;
  walker.motion = findMotionModel("constant-velocity");
  ObjectClass car = walker;
  car.motion = findMotionModel("wheeled");
  const double dt = 0.13;
  for (const SimdLevel level : levels()) {
    for (const auto& c : {walker, car}) {
      const bool wheeled = c.motion->has_heading;
      Rng rng({7, 0, 0, 0});
      BankBatch bank(kSize);
      MotionBatch motion(kSize);
      std::vector<ClassFilter> filters;
      for (std::size_t i = 0; i < kSize; ++i) {
        filters.push_back(randomFilter(rng, wheeled));
        put(filters[i], i, bank);
        motion[MotionBatch::kDecay][i] = 1;
        motion[MotionBatch::kEffectiveDt][i] = dt;
        motion[MotionBatch::kPp][i] = c.accel_psd * dt * dt * dt / 3;
        motion[MotionBatch::kPv][i] = c.accel_psd * dt * dt / 2;
        motion[MotionBatch::kVv][i] = c.accel_psd * dt;
        motion[MotionBatch::kSlip][i] = c.position_psd * dt;
        motion[MotionBatch::kYawPp][i] = c.yaw_rate_psd * dt * dt * dt / 3;
        motion[MotionBatch::kYawPy][i] = c.yaw_rate_psd * dt * dt / 2;
        motion[MotionBatch::kYawYy][i] = c.yaw_rate_psd * dt;
      }
      wheeled ? predictWheeled(motion, bank, level) : predictConstantVelocity(motion, bank, level);
      for (std::size_t i = 0; i < kSize; ++i) {
        predictClassFilter(c, dt, filters[i]);
        expectEqual(filters[i].x, filters[i].P, bank, i);
      }
    }
  }
}

TEST(PredictTracks, IsPredictTrackInBatches) {
  FilterModel model;
  model.classes = test::linearClasses();
  ObjectClass car = model.classes[0];
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  car.mode_accel_psd = {0.5, 3};
  car.mode_damping = {0, 1};
  car.mode_sojourn = {4, 1};
  model.classes.classes.push_back(car);
  Rng rng({9, 0, 0, 0});
  std::vector<TrackHandle> tracks;
  std::vector<char> touched;
  for (int i = 0; i < 30; ++i) {
    Track t;
    t.stamp = t.last_in_view = Stamp::fromSeconds(100 + 0.01 * (i % 5));
    t.existence = 0.9;
    t.log_class = {std::log(0.2), std::log(0.3), std::log(0.5)};
    for (const auto& c : model.classes.classes) {
      t.bank.push_back(randomFilter(rng, c.motion->has_heading && i % 3 > 0));
      startModes(c, t.bank.back());
    }
    tracks.push_back(std::make_shared<const Track>(t));
    touched.push_back(i % 7 != 0);
  }
  const Stamp to = Stamp::fromSeconds(100.2);
  const auto batch = predictTracks(tracks, touched, to, model);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!touched[i]) {
      EXPECT_TRUE(batch[i].bank.empty());
      continue;
    }
    const Track one = predictTrack(*tracks[i], to, model);
    EXPECT_EQ(batch[i].existence, one.existence);
    EXPECT_EQ(batch[i].log_class, one.log_class);
    for (std::size_t j = 0; j < one.bank.size(); ++j) {
      EXPECT_LT((batch[i].bank[j].x - one.bank[j].x).norm(), 1e-9);
      EXPECT_LT((batch[i].bank[j].P - one.bank[j].P).norm(), 1e-9);
      ASSERT_EQ(batch[i].bank[j].modes.size(), one.bank[j].modes.size());
    }
  }
}

}  // namespace
}  // namespace perception
