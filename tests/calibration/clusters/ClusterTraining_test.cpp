#include "libperception/calibration/clusters/ClusterTraining.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

// How errors repeat -------------------------------------------------------------------------------

/// Evidence of objects that are seen every tenth of a second from the same place.
struct Watched {
  ClusterSamples samples;
  std::vector<std::size_t> of;
  std::vector<double> evidence;

  /// Shares of the variance: `lasting` of the object; of the rest `kept` of a process that falls to
  /// 1/e within `time` [s].
  Watched(int objects, int views, double lasting, double kept, double time,
          std::uint64_t seed = 1) {
    Rng rng(RngKey{seed, 0, 0, 11});
    const double stays = std::exp(-0.1 / time);
    for (int o = 0; o < objects; ++o) {
      const double own = rng.normal();
      double slow = rng.normal();
      for (int k = 0; k < views; ++k) {
        ClusterSample s;
        s.t = 0.1 * k, s.object = o;
        s.kind = o % 2 ? ClusterKind::kVehicle : ClusterKind::kThing;
        s.view = {1, 3};
        of.push_back(samples.clusters.size());
        samples.clusters.push_back(s);
        const double error =
            std::sqrt(lasting) * own +
            std::sqrt(1 - lasting) * (std::sqrt(kept) * slow + std::sqrt(1 - kept) * rng.normal());
        evidence.push_back((o % 2 ? 2 : -3) + 1.5 * error);  // kinds differ in their mean
        slow = stays * slow + std::sqrt(1 - stays * stays) * rng.normal();
      }
    }
  }
  EvidenceMemory fit() const { return fitMemory(samples, of, evidence); }
};

TEST(EvidenceFit, RecoversWhatStaysAndHowTheRestChanges) {
  struct Case {
    double lasting, kept, time;
  };
  for (const Case c : {Case{0.3, 0.8, 1}, {0.05, 0.9, 1}, {0.6, 0.5, 0.3}}) {
    const EvidenceMemory memory = Watched(500, 30, c.lasting, c.kept, c.time).fit();
    EXPECT_NEAR(memory.lasting, c.lasting, 0.1);
    // Two views 0.3 s apart.
    const double expected = c.lasting + (1 - c.lasting) * c.kept * std::exp(-0.3 / c.time);
    const double found =
        memory.lasting + (1 - memory.lasting) * memory.correlation({1, 3}, {1, 3}, 0.3);
    EXPECT_NEAR(found, expected, 0.08) << c.lasting;
  }
}

TEST(EvidenceFit, ErrorsThatComeAndGoLeaveNothing) {
  const EvidenceMemory memory = Watched(300, 30, 0, 0, 1).fit();
  EXPECT_LT(memory.lasting, 0.05);
  EXPECT_EQ(memory.kept, 0.5) << "the least of the grid";
}

TEST(EvidenceFit, AChangeOfBearingIsToldFromThatOfTime) {
  // The changing part is another one on each side of the object; time has no effect.
  Watched w(0, 0, 0, 0, 1);
  Rng rng(RngKey{2, 0, 0, 11});
  for (int o = 0; o < 300; ++o) {
    const double sides[2] = {rng.normal(), rng.normal()};
    for (int k = 0; k < 12; ++k) {
      ClusterSample s;
      s.t = 0.3 * k, s.object = o, s.kind = ClusterKind::kVehicle;
      s.view = {k % 2 ? 2.0 : 1.0, 3};
      w.of.push_back(w.samples.clusters.size());
      w.samples.clusters.push_back(s);
      w.evidence.push_back(0.95 * sides[k % 2] + 0.3 * rng.normal());
    }
  }
  const EvidenceMemory memory = w.fit();
  EXPECT_EQ(memory.kept, 0.9);
  EXPECT_EQ(memory.time, 3) << "the longest of the grid";
  EXPECT_EQ(memory.bearing, 0.1);
}

TEST(EvidenceFit, FewPairsLeaveTheDefaults) {
  const EvidenceMemory defaults;
  EXPECT_EQ(Watched(19, 5, 0.9, 0.5, 0.3).fit().lasting, defaults.lasting) << "190 pairs";
  EXPECT_EQ(Watched(19, 5, 0.9, 0.5, 0.3).fit().time, defaults.time);
  EXPECT_NE(Watched(20, 5, 0.9, 0.5, 0.3).fit().lasting, defaults.lasting) << "200 pairs";
}

TEST(EvidenceFit, ViewsFarApartInTimeAreNoPairs) {
  Watched w(60, 5, 0.9, 0.5, 0.3);  // 600 pairs
  ASSERT_NE(w.fit().lasting, EvidenceMemory{}.lasting);
  for (ClusterSample& s : w.samples.clusters) s.t *= 50;  // 5 s apart
  EXPECT_EQ(w.fit().lasting, EvidenceMemory{}.lasting);
}

TEST(EvidenceFit, SamplesOfAnotherLogAreAnotherObject) {
  Watched w(60, 5, 0.9, 0.5, 0.3);
  for (ClusterSample& s : w.samples.clusters) s.log = static_cast<std::size_t>(s.t * 10 + 0.5);
  EXPECT_EQ(w.fit().lasting, EvidenceMemory{}.lasting);
}

// Classifiers -------------------------------------------------------------------------------------

/// Kinds by two features, apart by many deviations; the others are noise.
ClusterSamples separable(std::size_t logs, int each) {
  ClusterSamples samples;
  for (std::size_t log = 0; log < logs; ++log) {
    Rng rng(RngKey{9, log, 0, 11});
    for (int i = 0; i < each; ++i) {
      for (std::size_t k = 0; k < kClusterKinds; ++k) {
        ClusterSample s;
        s.log = log, s.t = 0.1 * i;
        s.kind = static_cast<ClusterKind>(k);
        s.object = static_cast<std::int64_t>(k) * 100 + i / 10;
        s.view = {0.02 * i, 3};
        for (float& v : s.descriptor) v = static_cast<float>(rng.normal());
        s.descriptor[4] += 10.0F * static_cast<float>(k % 3);
        s.descriptor[9] += 10.0F * static_cast<float>(k / 3);
        samples.clusters.push_back(s);
      }
    }
  }
  return samples;
}

double shareRight(const ClusterClassifier& classifier, const ClusterSamples& samples,
                  std::size_t log) {
  double right = 0, all = 0;
  for (const ClusterSample& s : samples.clusters) {
    if (s.log != log) continue;
    const auto p = classifier.probabilities(s.descriptor);
    const auto best = std::max_element(p.begin(), p.end()) - p.begin();
    all += 1, right += best == static_cast<std::ptrdiff_t>(*s.kind) ? 1 : 0;
  }
  return right / all;
}

const std::vector<TrainingLog> kThree = {{"a", false}, {"b", false}, {"c", false}};

TEST(ClusterTraining, TwoLogsTellTheKindsOfTheThird) {
  const ClusterSamples samples = separable(3, 20);
  ClusterTrainer trainer(samples, kThree, 1);
  const ClusterClassifier blind = trainer.classifier(2, {});
  EXPECT_GT(shareRight(blind, samples, 2), 0.97);
  for (const double share : blind.prior()) EXPECT_NEAR(share, 1.0 / 6, 1e-9);
  // Road users have evidence for their own kind, things none.
  int all = 0, own_is_greatest = 0;
  for (const ClusterSample& s : samples.clusters) {
    if (s.log != 2 || *s.kind == ClusterKind::kMixed) continue;
    const auto e = blind.evidence(s.descriptor);
    const double own = e[static_cast<std::size_t>(*s.kind)];
    ++all, own_is_greatest += *std::max_element(e.begin(), e.end()) <= own + 1e-9;
  }
  EXPECT_EQ(all, 100);
  EXPECT_GE(own_is_greatest, 97);
}

TEST(ClusterTraining, GivesTheSameBytesForTheSameSeed) {
  const ClusterSamples samples = separable(3, 8);
  const auto bytes = [&](std::uint64_t seed) {
    return ClusterTrainer(samples, kThree, seed)
        .classifier(3, {"1", "today", "CC0", {"a"}, false})
        .write();
  };
  const std::string first = bytes(1);
  EXPECT_EQ(bytes(1), first);
  EXPECT_NE(bytes(2), first);
}

TEST(ClusterTraining, TheLogLeftOutHasNoEffect) {
  ClusterSamples samples = separable(3, 8);
  const std::string first = ClusterTrainer(samples, kThree, 1).classifier(1, {}).write();
  for (ClusterSample& s : samples.clusters)
    if (s.log == 1) s.descriptor.fill(3), s.kind = ClusterKind::kCyclist, s.object = 7;
  EXPECT_EQ(ClusterTrainer(samples, kThree, 1).classifier(1, {}).write(), first);
  EXPECT_NE(ClusterTrainer(samples, kThree, 1).classifier(3, {}).write(), first);
}

TEST(ClusterTraining, LeftOutProbabilitiesAreOfTheSamplesOfTheLog) {
  ClusterSamples samples = separable(3, 8);
  samples.clusters.resize(samples.clusters.size() - 24);  // the last log is shorter
  ClusterTrainer trainer(samples, kThree, 1);
  for (std::size_t log = 0; log < 3; ++log) {
    for (std::size_t without = 0; without <= 3; ++without) {
      const auto& p = trainer.leftOut(log, without);
      ASSERT_EQ(p.size(), trainer.of(log).size());
      for (std::size_t i = 0; i < p.size(); ++i) {
        double sum = 0;
        for (const double v : p[i]) sum += v;
        ASSERT_NEAR(sum, 1, 1e-12);
      }
    }
  }
  EXPECT_EQ(trainer.of(2).size(), 24u);
  EXPECT_EQ(trainer.of(1).front(), 48u);
}

TEST(ClusterTraining, SimulatedLogsDoNotCalibrateBesideRecordedOnes) {
  ClusterSamples samples = separable(4, 5);
  for (ClusterSample& s : samples.clusters)  // of the last log just two kinds
    if (s.log == 3)
      s.kind = *s.kind == ClusterKind::kThing ? ClusterKind::kThing : ClusterKind::kVehicle;
  const std::vector<TrainingLog> recorded = {
      {"a", false}, {"b", false}, {"c", false}, {"d", false}};
  std::vector<TrainingLog> one_simulated = recorded;
  one_simulated[3].simulated = true;
  const auto vehicles = [&](const std::vector<TrainingLog>& logs) {
    return ClusterTrainer(samples, logs, 1).classifier(4, {}).prior()[2];
  };
  EXPECT_NEAR(vehicles(one_simulated), 1.0 / 6, 1e-9);
  EXPECT_GT(vehicles(recorded), 0.3);
}

TEST(ClusterTraining, ALogWithoutSamplesHasNoEffect) {
  const ClusterSamples samples = separable(3, 8);
  std::vector<TrainingLog> four = kThree;
  four.push_back({"empty", false});
  ClusterTrainer three(samples, kThree, 1), with_empty(samples, four, 1);
  for (std::size_t without = 0; without < 3; ++without)
    EXPECT_EQ(with_empty.classifier(without, {}).write(), three.classifier(without, {}).write());
  // Once more, as ClusterStudy asks for each log in turn.
  with_empty.classifier(3, {});
  EXPECT_EQ(with_empty.leftOut(0, 3).size(), with_empty.of(0).size());
}

}  // namespace
}  // namespace perception
