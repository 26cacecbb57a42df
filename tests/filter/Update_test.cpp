#include "libperception/filter/Update.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "libperception/filter/Prediction.h"
#include "libperception/filter/Step.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

struct Fixture {
  std::shared_ptr<const PositionModel> sensor =
      std::make_shared<const PositionModel>(linearSensor());
  FilterModel model = exactModel(linearClasses());

  Track born() const {
    const auto scan = positionScan(sensor, 0, {{1, 2, 0}});
    return newTrack(likelihoodTable({}, scan, model).news[0], 0, scan, 0, model);
  }
};

TEST(NewTrack, IsABernoulliOfBirthAgainstClutter) {
  const Fixture f;
  const Track t = f.born();
  const auto& p = f.sensor->params();
  const double birth = p.births_per_scan * (0.6 * 0.7 + 0.4 * 0.4),
               clutter = p.clutter_per_scan * 0.5;
  EXPECT_NEAR(t.existence, birth / (birth + clutter), 1e-12);
  EXPECT_NEAR(std::exp(t.log_class[0]), 0.6 * 0.7 / (0.6 * 0.7 + 0.4 * 0.4), 1e-12);
}

TEST(MissTrack, CostsExistenceAndTheClassesThatShouldHaveBeenSeen) {
  const Fixture f;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  const auto scan = positionScan(f.sensor, 0.1, {});
  const auto table = likelihoodTable({before}, scan, f.model);
  const Track after = missTrack(before, table.tracks[0], scan, f.model);
  const auto pc = classProbabilities(before);
  const double detection = pc[0] * 0.8 + pc[1] * 0.6;
  EXPECT_NEAR(after.existence,
              before.existence * (1 - detection) / (1 - before.existence * detection), 1e-12);
  EXPECT_NEAR(std::exp(after.log_class[0]), pc[0] * 0.2 / (1 - detection), 1e-12);
}

TEST(HitTrack, MakesExistenceCertainAndClassesSumToOne) {
  Fixture f;
  f.model.params.existence_max = 0.999;
  f.model.params.class_epsilon = 1e-3;
  const Track before = predictTrack(f.born(), Stamp::fromSeconds(1000.1), f.model);
  const auto scan = positionScan(f.sensor, 0.1, {{1.05, 2, 0}});
  const auto table = likelihoodTable({before}, scan, f.model);
  ASSERT_EQ(table.tracks[0].pairs.size(), 1u);
  const Track after = hitTrack(before, table.tracks[0], table.tracks[0].pairs[0], scan, 1, f.model);
  EXPECT_EQ(after.existence, 0.999);
  const auto p = classProbabilities(after);
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
  EXPECT_NE(after.history, before.history);
  EXPECT_EQ(after.hits[modalityIndex(scan.modality)], 2);
}

TEST(HitTrack, NeverLetsAClassDie) {
  Fixture f;
  f.model.params.class_epsilon = 1e-3;
  Track t = f.born();
  for (int i = 1; i <= 200; ++i) {  // a steady walk: nothing static about it
    const auto scan = positionScan(f.sensor, 0.1 * i, {{1 + 0.15 * i, 2, 0}});
    const Track predicted = predictTrack(t, scan.state.stamp, f.model);
    const auto table = likelihoodTable({predicted}, scan, f.model);
    ASSERT_EQ(table.tracks[0].pairs.size(), 1u) << i;
    t = hitTrack(predicted, table.tracks[0], table.tracks[0].pairs[0], scan,
                 static_cast<std::uint64_t>(i), f.model);
  }
  const auto p = classProbabilities(t);
  EXPECT_GT(p[0], 0.99);
  EXPECT_GE(p[1], 0.9e-3);
  // The filter that lost it starts anew from the measurement instead of hanging behind.
  EXPECT_NEAR(t.bank[1].x[0], 1 + 0.15 * 200, 2);
}

TEST(Gate, KeepsExactlyTheQuantile) {
  const Fixture f;
  FilterModel model = f.model;
  model.params.gate_probability = 0.999;
  const Track t = predictTrack(f.born(), Stamp::fromSeconds(1000), model);
  // The walker's innovation covariance at dt = 0 is its birth covariance plus its noise: isotropic.
  const double variance = 2 * (0.04 + 1e-4) + 1e-9, static_variance = 2 * (0.09 + 1e-4) + 1e-9;
  const double quantile = 13.815510557964274;  // chi-square .999, two degrees of freedom
  const double edge = std::sqrt(quantile * std::max(variance, static_variance));
  for (const double factor : {0.9999, 1.0001}) {
    const auto scan = positionScan(f.sensor, 0, {{1 + factor * edge, 2, 0}});
    EXPECT_EQ(likelihoodTable({t}, scan, model).tracks[0].pairs.size(), factor < 1 ? 1u : 0u);
  }
}

TEST(Prediction, FadesWhatNobodyCouldSee) {
  Fixture f;
  f.model.params.survival_in_view = 60;
  f.model.params.survival_out_of_view = 6;
  Track t = f.born();
  t.existence = 0.9;
  EXPECT_NEAR(predictTrack(t, t.stamp + 0.5, f.model).existence, 0.9 * std::exp(-0.5 / 60), 1e-12);
  EXPECT_NEAR(predictTrack(t, t.stamp + 3.0, f.model).existence, 0.9 * std::exp(-3.0 / 6), 1e-12);
}

}  // namespace
}  // namespace perception
