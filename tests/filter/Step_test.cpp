#include "libperception/filter/Step.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "libperception/core/Error.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/CRbpfTracker.h"
#include "tests/support/Enumeration.h"

namespace perception {
namespace {

using test::exactModel;
using test::linearClasses;
using test::linearSensor;
using test::positionScan;

/// Tiny scenes full of ambiguity: births, clutter, misses, two classes.
struct TinyScene {
  const char* name;
  std::vector<std::vector<test::LabeledPoint>> scans;
  double dt;
};

const std::vector<TinyScene>& tinyScenes() {
  static const std::vector<TinyScene> scenes = {
      {"two objects cross, one false return",
       {{{0, 0, 0}, {1, 0, 1}},
        {{0.4, 0.1, 0}, {0.7, 0, 1}, {3, 3, 1}},
        {{0.6, 0.1, 1}, {0.5, 0, 0}},
        {{0.9, 0, 0}}},
       0.5},
      {"three close objects, one is missed",
       {{{0, 0, 0}, {0.5, 0.3, 0}, {-0.4, 0.4, 1}},
        {{0.1, 0.1, 1}, {0.4, 0.4, 0}},
        {{0.2, 0.2, 0}, {0.3, 0.2, 0}, {-0.4, 0.3, 1}}},
       0.3},
      {"nothing for a scan, then two",
       {{{0, 0, 0}}, {}, {{0.3, 0, 0}, {0, 0, 1}}, {{0.5, 0, 0}, {0, 0.1, 1}}},
       0.4},
  };
  return scenes;
}

std::vector<MeasurementScan> scansOf(const TinyScene& scene,
                                     const std::shared_ptr<const PositionModel>& sensor) {
  std::vector<MeasurementScan> scans;
  for (std::size_t i = 0; i < scene.scans.size(); ++i) {
    scans.push_back(positionScan(sensor, scene.dt * static_cast<double>(i), scene.scans[i]));
  }
  return scans;
}

std::vector<std::uint64_t> keyOf(const Hypothesis& h) {
  std::vector<std::uint64_t> key;
  for (const auto& t : h.tracks) key.push_back(t->history);
  std::sort(key.begin(), key.end());
  return key;
}

/// Self-normalized importance estimates with their standard errors.
struct Estimate {
  std::map<std::vector<std::uint64_t>, double> probability, variance;
};

Estimate estimate(const Posterior& posterior) {
  const auto& hypotheses = posterior.hypotheses;
  std::vector<double> log_weights = posterior.log_weights;
  logNormalize(log_weights);
  Estimate e;
  std::vector<std::vector<std::uint64_t>> keys;
  for (const auto& h : hypotheses) keys.push_back(keyOf(*h));
  for (std::size_t i = 0; i < keys.size(); ++i) e.probability[keys[i]] += std::exp(log_weights[i]);
  double squares = 0;
  std::map<std::vector<std::uint64_t>, double> own;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const double w2 = std::exp(2 * log_weights[i]);
    squares += w2;
    own[keys[i]] += w2;
  }
  for (const auto& [key, p] : e.probability)
    e.variance[key] = own[key] * (1 - 2 * p) + p * p * squares;
  return e;
}

class ExactEnumeration : public testing::TestWithParam<std::size_t> {};

TEST_P(ExactEnumeration, IsWhatTheSampledPosteriorConvergesTo) {
  const TinyScene& scene = tinyScenes()[GetParam()];
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto scans = scansOf(scene, sensor);
  const auto exact = test::enumerateExactly(scans, *sensor, model);

  const std::size_t n = 40000;
  Posterior posterior = Posterior::empty(n);
  for (std::size_t s = 0; s < scans.size(); ++s)
    posterior = step(posterior, scans[s], model, {7, s, 0, 0}, n).posterior;
  const auto& log_weights = posterior.log_weights;

  // 5 standard errors and a few hundred comparisons: a false alarm once in ten thousand runs, and
  // the seed is fixed.
  const Estimate e = estimate(posterior);
  double covered = 0;
  for (const auto& [key, history] : exact.histories) {
    const auto found = e.probability.find(key);
    if (found == e.probability.end()) {
      EXPECT_LT(history.probability, 0.002) << scene.name;
      continue;
    }
    covered += history.probability;
    const double sigma = std::sqrt(e.variance.at(key)) + std::sqrt(history.probability / n) + 1e-6;
    EXPECT_NEAR(found->second, history.probability, 5 * sigma) << scene.name;
  }
  EXPECT_GT(covered, 0.99) << scene.name;

  // The mean weight is an unbiased estimate of the evidence (Poisson normalizers left out in both).
  const double log_mean = logSumExp(log_weights) - std::log(static_cast<double>(n));
  double spread = 0;
  for (const double lw : log_weights) spread += std::pow(std::exp(lw - log_mean) - 1, 2);
  const double sigma = std::sqrt(spread) / static_cast<double>(n);
  EXPECT_NEAR(std::exp(log_mean - exact.log_evidence), 1, 5 * sigma + 1e-6) << scene.name;

  // Given the history everything is exact: existence, class, position.
  std::size_t compared = 0;
  for (const auto& h : posterior.hypotheses) {
    const auto& history = exact.histories.at(keyOf(*h));
    for (const auto& t : h->tracks) {
      const auto& truth = history.tracks.at(t->history);
      ASSERT_NEAR(t->existence, truth.existence, 1e-6);
      const auto p = classProbabilities(*t);
      Vector2 mean = Vector2::Zero();
      for (std::size_t j = 0; j < p.size(); ++j) {
        ASSERT_NEAR(p[j], truth.classes[j], 1e-6);
        mean += p[j] * t->bank[j].x.head<2>();
      }
      ASSERT_LT((mean - truth.mean).norm(), 1e-6);
      ++compared;
    }
    if (compared > 2000) break;
  }
  EXPECT_GT(compared, 1000u);
}

INSTANTIATE_TEST_SUITE_P(TinyScenes, ExactEnumeration, testing::Range<std::size_t>(0, 3));

Posterior ranked(const std::vector<MeasurementScan>& scans, FilterModel model, int children,
                 std::size_t slots, Proposal proposal = Proposal::kRanked) {
  model.proposal = proposal;
  model.params.ranked_children = children;
  model.params.ranked_span = 1e6;
  Posterior p = Posterior::empty(1);
  for (std::size_t s = 0; s < scans.size(); ++s)
    p = step(p, scans[s], model, {0, s, 0, 0}, slots).posterior;
  return p;
}

TEST_P(ExactEnumeration, IsTheRankedPosteriorWhenAllAssignmentsAreTaken) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto scans = scansOf(tinyScenes()[GetParam()], sensor);
  const auto exact = test::enumerateExactly(scans, *sensor, model);
  const Posterior p = ranked(scans, model, 1000, 1000000);
  std::map<std::vector<std::uint64_t>, double> found;
  for (std::size_t i = 0; i < p.hypotheses.size(); ++i)
    found[keyOf(*p.hypotheses[i])] = std::exp(p.log_weights[i] - exact.log_evidence);
  ASSERT_EQ(found.size(), p.hypotheses.size());       // no history twice
  for (const auto& [key, history] : exact.histories)  // those outside the gate have no weight
    ASSERT_NEAR(found[key], history.probability, 1e-10);
  EXPECT_NEAR(logSumExp(p.log_weights), exact.log_evidence, 1e-10);
}

TEST_P(ExactEnumeration, IsMissedByFewRankedHypothesesByTheDroppedMassAtMost) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto scans = scansOf(tinyScenes()[GetParam()], sensor);
  const auto exact = test::enumerateExactly(scans, *sensor, model);
  double dropped_before = 1;
  for (const std::size_t slots : {1u, 8u, 64u}) {
    const Posterior p = ranked(scans, model, 4, slots);
    ASSERT_LE(p.hypotheses.size(), slots);
    const double total = logSumExp(p.log_weights);
    const double dropped = 1 - std::exp(total - exact.log_evidence);
    EXPECT_GE(dropped, -1e-12);
    EXPECT_LE(dropped, dropped_before);
    dropped_before = dropped;
    for (std::size_t i = 0; i < p.hypotheses.size(); ++i) {
      const double truth = exact.histories.at(keyOf(*p.hypotheses[i])).probability;
      // Weights are exact before they are normalized.
      EXPECT_NEAR(std::exp(p.log_weights[i] - exact.log_evidence), truth, 1e-10);
      EXPECT_LE(std::abs(std::exp(p.log_weights[i] - total) - truth), dropped + 1e-10);
    }
  }
}

TEST(Step, NearestKeepsTheLikeliestAssignmentOfEachScan) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto scans = scansOf(tinyScenes()[1], sensor);
  const Posterior nearest = ranked(scans, model, 4, 8, Proposal::kNearest);
  ASSERT_EQ(nearest.hypotheses.size(), 1u);
  const Posterior one = ranked(scans, model, 1, 1);
  EXPECT_EQ(nearest.hypotheses[0]->key, one.hypotheses[0]->key);
}

TEST(Step, DoesTheWorkOfADistinctTrackOnce) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto result = step(Posterior::empty(1000), positionScan(sensor, 0, {{0, 0, 0}, {1, 0, 1}}),
                           model, {1, 0, 0, 0}, 1000)
                          .posterior;
  EXPECT_EQ(result.hypotheses[0]->tracks.size(), 2u);
  for (const auto& h : result.hypotheses) EXPECT_EQ(h.get(), result.hypotheses[0].get());
  const auto next =
      step(result, positionScan(sensor, 0.1, {{0, 0, 0}}), model, {1, 1, 0, 0}, 1000).stats;
  EXPECT_EQ(next.distinct_tracks, 2u);
}

TEST(Step, IsAFunctionOfItsArguments) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const FilterModel model = exactModel(linearClasses());
  const auto scans = scansOf(tinyScenes()[0], sensor);
  std::vector<double> first;
  for (int run = 0; run < 2; ++run) {
    Posterior p = Posterior::empty(64);
    std::vector<double> weights;
    for (std::size_t s = 0; s < scans.size(); ++s) {
      p = step(p, scans[s], model, {3, s, 0, 0}, 64).posterior;
      weights.insert(weights.end(), p.log_weights.begin(), p.log_weights.end());
    }
    if (run == 0) first = weights;
    EXPECT_EQ(first, weights);
  }
}

TEST(MapHypothesis, AddsUpSlotsOfEqualHistory) {
  const auto track = [](std::uint64_t history) {
    auto t = std::make_shared<Track>();
    t->history = history;
    return t;
  };
  const auto one = [&](std::uint64_t history) {
    return std::make_shared<const Hypothesis>(std::vector<TrackHandle>{track(history)});
  };
  const Posterior posterior{{one(2), one(1), one(1)},
                            {std::log(0.4), std::log(0.3), std::log(0.3)}};
  const auto best = mapHypothesis(posterior);
  EXPECT_EQ(best.slot, 1u);
  EXPECT_NEAR(best.probability, 0.6, 1e-12);
  EXPECT_EQ(best.distinct, 2u);
}

CRbpfTracker::Options options(int particles, double beta) {
  ParticleFilterParams p;
  p.sample_size = particles;
  p.beta = beta;
  return p.toMrpt();
}

TEST(CRbpfTracker, GivesThePosteriorOfExactEnumerationThroughMrpt) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const auto scans = scansOf(tinyScenes()[0], sensor);
  const FilterModel model = exactModel(linearClasses());
  const auto exact = test::enumerateExactly(scans, *sensor, model);
  for (const double beta : {0.0, 0.9}) {  // with and without resampling on the way
    CRbpfTracker tracker(model, options(40000, beta), 11);
    for (const auto& s : scans) ASSERT_TRUE(tracker.process(s));
    std::map<std::vector<std::uint64_t>, double> p;
    double total = 0, squares = 0;
    for (const auto& particle : tracker.m_particles) {
      const double w = std::exp(particle.log_w);
      p[keyOf(*particle.d)] += w;
      total += w;
      squares += w * w;
    }
    const double effective = total * total / squares;
    for (const auto& [key, history] : exact.histories) {
      if (history.probability < 0.01) continue;
      // Resampling four times adds at most its own variance again: twice the binomial error bounds
      // it.
      const double sigma =
          2 * std::sqrt(history.probability * (1 - history.probability) / std::min(effective, 1e4));
      EXPECT_NEAR(p[key] / total, history.probability, 5 * sigma) << "BETA " << beta;
    }
  }
}

TEST(CRbpfTracker, HasEqualWeightsRightAfterResampling) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  for (int method = 0; method < 4; ++method) {
    ParticleFilterParams params;
    params.sample_size = 200;
    params.beta = 1;
    params.resampling_method = method;
    CRbpfTracker tracker(exactModel(linearClasses()), params.toMrpt(), 5);
    int resampled = 0;
    for (const auto& s : scansOf(tinyScenes()[1], sensor)) {
      tracker.process(s);
      if (!tracker.stats().resampled) continue;
      ++resampled;
      EXPECT_LT(tracker.stats().ess, 1);
      EXPECT_NEAR(tracker.ESS(), 1, 1e-12) << "method " << method;
    }
    EXPECT_GT(resampled, 0);
  }
}

TEST(CRbpfTracker, IsExecutedByMrptsParticleFilter) {
  CRbpfTracker tracker(exactModel(linearClasses()), options(4, 0.5), 5);
  mrpt::bayes::CParticleFilter executor;
  executor.m_options = options(4, 0.5);
  // executeOn reaches our optimal proposal, which asks for a scan; no other algorithm exists.
  try {
    executor.executeOn(tracker, nullptr, nullptr);
    FAIL() << "ran without a scan";
  } catch (const std::exception& e) {  // MRPT adds its own call stack to ours
    EXPECT_NE(std::string(e.what()).find("CRbpfTracker: executed without a scan"),
              std::string::npos)
        << e.what();
  }
  auto wrong = options(4, 0.5);
  wrong.PF_algorithm = mrpt::bayes::CParticleFilter::pfStandardProposal;
  EXPECT_THROW(CRbpfTracker(exactModel(linearClasses()), wrong, 5), ConfigError);
}

TEST(CRbpfTracker, RefusesAScanFromThePast) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  CRbpfTracker tracker(exactModel(linearClasses()), options(4, 0.5), 5);
  EXPECT_TRUE(tracker.process(positionScan(sensor, 1, {{0, 0, 0}})));
  EXPECT_FALSE(tracker.process(positionScan(sensor, 0.5, {{0, 0, 0}})));
  EXPECT_TRUE(tracker.process(positionScan(sensor, 1, {{1, 0, 0}})));
}

TEST(CRbpfTracker, RepeatsARunToTheBit) {
  const auto sensor = std::make_shared<const PositionModel>(linearSensor());
  const auto weights = [&](std::uint64_t seed) {
    CRbpfTracker tracker(exactModel(linearClasses()), options(50, 0.8), seed);
    std::vector<double> w;
    for (const auto& s : scansOf(tinyScenes()[0], sensor)) {
      tracker.process(s);
      for (const auto& p : tracker.m_particles) w.push_back(p.log_w);
    }
    return w;
  };
  EXPECT_EQ(weights(1), weights(1));
  EXPECT_NE(weights(1), weights(2));
}

TEST(Step, TellsWhichMeasurementsAreOfTracks) {
  for (const Proposal proposal : {Proposal::kSampled, Proposal::kRanked}) {
    const auto sensor = std::make_shared<const PositionModel>(linearSensor());
    FilterModel model = exactModel(linearClasses());
    model.proposal = proposal;
    Posterior posterior = Posterior::empty(proposal == Proposal::kSampled ? 200 : 1);
    const std::vector<std::vector<test::LabeledPoint>> points = {
        {{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 0}}, {{0, 0, 0}, {20, 20, 1}}};
    StepResult result;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto scan = positionScan(sensor, 0.1 * static_cast<double>(k), points[k]);
      result = step(posterior, scan, model, {1, k, 0, 0}, 200);
      posterior = result.posterior;
    }
    ASSERT_EQ(result.stats.of_tracks.size(), 2U);
    EXPECT_GT(result.stats.of_tracks[0], 0.95);
    EXPECT_LT(result.stats.of_tracks[1], 0.05);
  }
}

}  // namespace
}  // namespace perception
