#include "libperception/filter/likelihood/AssignmentPrior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libperception/core/math/Random.h"
#include "libperception/filter/Step.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/update/Update.h"
#include "tests/support/FilterWorld.h"

namespace perception {
namespace {

using test::positionScan;

struct PriorFixture {
  std::shared_ptr<const PositionModel> sensor =
      std::make_shared<const PositionModel>(test::linearSensor());
  FilterModel model = test::exactModel(test::linearClasses());

  Track born(double x) const {
    const auto scan = positionScan(sensor, 0, {{x, 2, 0}});
    return newTrack(likelihoodTable({}, scan, model).births[0], 0, scan, 0, model);
  }
  /// The same with a height that is known to 5 cm.
  Track high(double x, double height) const {
    Track t = born(x);
    t.height = {height, 0.0025};
    return t;
  }
  MeasurementScan seen(double t, double x, double height) const {
    auto scan = positionScan(sensor, t, {{x, 2, 0}});
    scan.measurements[0].height = ScalarEstimate{height, 0.01};
    return scan;
  }
};

/// The integral of exp(log density) over heights from -20 to 24 m, lowest points from -20 to 20 m.
template <class LogDensity>
double integral(const LogDensity& log_density) {
  constexpr double kStep = 0.01;
  double sum = 0;
  for (double v = -20; v < 20; v += kStep) sum += kStep * std::exp(log_density(v));
  return sum;
}

TEST(ShapePrior, EveryCauseHasANormalisedDensity) {
  const PriorFixture f;
  const Track track = f.high(1, 1.7);
  const SensorState sensor;
  const auto height = [](double v) {
    Measurement m;
    m.height = ScalarEstimate{v, 0.01};
    return m;
  };
  const auto base = [](double v) {
    Measurement m;
    m.base_z = ScalarEstimate{v, 0.01};
    return m;
  };
  // A hundredth has any height from 0 to 4 m, written as a constant: it integrates to .01 there.
  const double rest = 0.01 * (40 / 4.0);
  for (const auto& of :
       {std::function<Measurement(double)>(height), std::function<Measurement(double)>(base)}) {
    EXPECT_NEAR(integral([&](double v) { return logShape(track, of(v)); }), 0.99 + rest, 2e-3);
    EXPECT_NEAR(integral([&](double v) { return logShape(f.model.classes[0], of(v), sensor); }),
                0.99 + rest, 2e-3);
  }
  BirthLikelihood births;
  births.log_class = {std::log(0.6), std::log(0.4)};
  weighShape(height(1), sensor, f.model, births);
  EXPECT_NEAR(4 * std::exp(births.log_clutter), 1, 1e-12) << "uniform over four meters";
}

TEST(ShapePrior, IsNothingWhereADetectionHasNoShape) {
  PriorFixture f;
  const Track t = predictTrack(f.high(1, 1.7), Stamp::fromSeconds(1000.1), f.model);
  const auto scan = positionScan(f.sensor, 0.1, {{1, 2, 0}});
  const auto plain = likelihoodTable({t}, scan, f.model);
  f.model.params.shape_prior = true;
  const auto weighed = likelihoodTable({t}, scan, f.model);
  EXPECT_EQ(weighed.tracks[0].pairs[0].log_prior, 0);
  EXPECT_EQ(weighed.births[0].log_new, plain.births[0].log_new);
}

TEST(ShapePrior, GivesTheHighClusterToTheHighObject) {
  PriorFixture f;
  const Stamp at = Stamp::fromSeconds(1000.1);
  const Track child = predictTrack(f.high(1, 1.1), at, f.model);
  const Track grown = predictTrack(f.high(1.2, 1.8), at, f.model);
  const auto scan = f.seen(0.1, 1.05, 1.8);  // nearer to the child
  const auto odds = [&](const Track& t) {
    const auto table = likelihoodTable({t}, scan, f.model);
    return table.tracks[0].pairs.at(0).log_likelihood + table.tracks[0].pairs[0].log_prior;
  };
  EXPECT_GT(odds(child), odds(grown));
  f.model.params.shape_prior = true;
  EXPECT_LT(odds(child) + 3, odds(grown));
}

TEST(ShapePrior, LeavesTheClassesToTheUpdate) {
  PriorFixture f;
  const auto scan = f.seen(0, 1, 1.7);
  const auto plain = likelihoodTable({}, scan, f.model).births[0];
  f.model.params.shape_prior = true;
  const auto weighed = likelihoodTable({}, scan, f.model).births[0];
  EXPECT_EQ(weighed.log_class, plain.log_class);
  EXPECT_NE(weighed.existence, plain.existence);
  EXPECT_NEAR(weighed.existence, std::exp(weighed.log_birth - weighed.log_new), 1e-12);
}

/// A track that was last seen `error` meters off in x.
struct Seen {
  PriorFixture f;
  Track track;
  explicit Seen(double error) {
    f.model.params.region_memory = 0.8;
    f.model.params.region_time = 1e9;
    track = predictTrack(f.born(1), Stamp::fromSeconds(1000.1), f.model);
    const auto scan = positionScan(f.sensor, 0, {{track.bank[0].x[0] + error, 2, 0}});
    rememberRegion(scan.measurements[0], scan, f.model, track);
  }
  double logDensity(double x) const {
    const auto scan = positionScan(f.sensor, 0.1, {{x, 2, 0}});
    const auto table = likelihoodTable({track}, scan, f.model);
    return table.tracks[0].pairs.at(0).log_likelihood + table.tracks[0].pairs[0].log_prior;
  }
};

TEST(RegionMemory, KeepsTheResidualOfTheSensorsLastMeasurement) {
  const Seen s(0.3);
  ASSERT_EQ(s.track.regions.size(), 1u);
  EXPECT_NEAR(s.track.regions[0].error[0], 0.3, 1e-12);
  EXPECT_NEAR(s.track.regions[0].error[1], 2 - s.track.bank[0].x[1], 1e-12);
}

TEST(RegionMemory, ExpectsTheNextMeasurementWhereTheLastOneWas) {
  const Seen s(0.3);
  const double x = s.track.bank[0].x[0];
  EXPECT_NEAR(s.logDensity(x + 0.24 + 0.1), s.logDensity(x + 0.24 - 0.1), 1e-9) << "0.8 of 0.3 m";
  EXPECT_GT(s.logDensity(x + 0.24), s.logDensity(x));
}

TEST(RegionMemory, IsADensityOverTheSameAxes) {
  // Over the plane it integrates to what the plain likelihood does: P_D and label alone.
  Seen s(0.3);
  const auto mass = [&] {
    constexpr double kStep = 0.08;
    double sum = 0;
    for (double x = -8; x < 10; x += kStep) {
      for (double y = -7; y < 11; y += kStep) {
        const auto scan = positionScan(s.f.sensor, 0.1, {{x, y, 0}});
        const auto table = likelihoodTable({s.track}, scan, s.f.model);
        for (const auto& p : table.tracks[0].pairs)
          sum += kStep * kStep * std::exp(p.log_likelihood + p.log_prior);
      }
    }
    return sum;
  };
  const double with = mass();
  s.f.model.params.region_memory = 0;
  EXPECT_NEAR(with, mass(), 2e-3 * with);
}

TEST(RegionMemory, FadesWithTime) {
  Seen s(0.3);
  s.f.model.params.region_time = 0.01;
  const double faded = s.logDensity(1.1);
  s.f.model.params.region_memory = 0;
  EXPECT_NEAR(faded, s.logDensity(1.1), 1e-3);
}

TEST(RegionMemory, TellsApartTwoWhoseErrorsGoOn) {
  // Two walkers side by side, each seen with an error that stays: memory confuses them less often.
  const auto swaps = [](double memory) {
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      PriorFixture f;
      f.model.proposal = Proposal::kNearest;
      f.model.params.region_memory = memory;
      Rng rng({seed, 0, 0, 0x4e61});
      Posterior posterior = Posterior::empty(1);
      Vector2 error[2];
      for (auto& e : error) e = 0.2 * Vector2(rng.normal(), rng.normal());
      std::vector<std::uint64_t> first;
      for (std::uint64_t k = 0; k < 30; ++k) {
        std::vector<test::LabeledPoint> points;
        for (int i = 0; i < 2; ++i) {
          error[i] = 0.95 * error[i] + 0.062 * Vector2(rng.normal(), rng.normal());
          const double gap = k < 8 ? 1.5 : 0.35;
          points.push_back(
              {0.1 * static_cast<double>(k) + error[i].x(), i * gap + error[i].y(), 0});
        }
        const auto scan = positionScan(f.sensor, 0.1 * static_cast<double>(k), points);
        posterior = step(posterior, scan, f.model, {1, k, 0, 0}, 1).posterior;
      }
      // Whose id follows whom is told by the order of birth: measurement 0 is walker 0's.
      const auto& tracks = posterior.hypotheses[0]->tracks;
      for (const auto& t : tracks) {
        if (t->id > 1) continue;
        const double y = t->bank[0].x[1] - (error[0].y() + error[1].y()) / 2;
        const double gap = 0.35 + error[1].y() - error[0].y();
        const bool upper = (y - 0.175) * (gap > 0 ? 1 : -1) > 0;
        count += upper != (t->id == 1);
      }
    }
    return count;
  };
  const int without = swaps(0), with = swaps(0.9);
  EXPECT_GT(without, 5) << "hard enough to tell";
  EXPECT_LT(with, without);
}

}  // namespace
}  // namespace perception
