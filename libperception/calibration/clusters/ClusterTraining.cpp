#include "libperception/calibration/clusters/ClusterTraining.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "libperception/calibration/clusters/Isotonic.h"
#include "libperception/calibration/clusters/ShapeExamples.h"
#include "libperception/calibration/clusters/TreeTraining.h"

namespace perception {
namespace {

constexpr double kMostOfLog = 400;          // samples of a kind by which a log counts
constexpr double kSimulatedShare = 0.3;     // of a simulated log beside recorded ones
constexpr double kFewSamples = 50;          // of a kind: its map is then half way to none
constexpr std::size_t kMostSamples = 4000;  // of a kind and log, evenly thinned

ClusterTrainer::Probabilities softmax(const BoostedTrees& trees, const Descriptor& d) {
  double scores[kClusterKinds];
  trees.scores(d, scores);
  const double most = *std::max_element(std::begin(scores), std::end(scores));
  ClusterTrainer::Probabilities p{};
  double sum = 0;
  for (std::size_t k = 0; k < kClusterKinds; ++k) sum += p[k] = std::exp(scores[k] - most);
  for (double& v : p) v /= sum;
  return p;
}

}  // namespace

ClusterTrainer::ClusterTrainer(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                               std::uint64_t seed)
    : samples_(samples), logs_(logs), seed_(seed), of_log_(logs.size()) {
  for (const TrainingLog& log : logs) recorded_ = recorded_ || !log.simulated;
  left_out_.assign(logs.size(), std::vector<std::vector<Probabilities>>(logs.size() + 1));
  for (std::size_t i = 0; i < samples.clusters.size(); ++i)
    of_log_[samples.clusters[i].log].push_back(i);
}

BoostedTrees ClusterTrainer::train(std::size_t without, std::size_t without_too) const {
  std::vector<TrainingSample> training;
  std::array<double, kClusterKinds> sum{};  // of the logs' says in each kind
  struct Part {
    std::size_t begin, end, kind;
    double say;
  };
  std::vector<Part> parts;
  const auto addPart = [&](const std::vector<std::size_t>& indices, std::size_t kind, double say) {
    const std::size_t begin = training.size(), stride = 1 + (indices.size() - 1) / kMostSamples;
    for (std::size_t i = 0; i < indices.size(); i += stride)
      training.push_back(
          {&samples_.clusters[indices[i]].descriptor, static_cast<ClusterKind>(kind), 1});
    parts.push_back({begin, training.size(), kind, say});
  };
  for (std::size_t log = 0; log < logs_.size(); ++log) {
    if (log == without || log == without_too) continue;
    std::array<std::vector<std::size_t>, kClusterKinds> of_kind;
    for (const std::size_t i : of_log_[log]) {
      const ClusterSample& sample = samples_.clusters[i];
      if (sample.kind) of_kind[static_cast<std::size_t>(*sample.kind)].push_back(i);
    }
    for (std::size_t k = 0; k < kClusterKinds; ++k) {
      if (of_kind[k].empty()) continue;
      const double say = std::min(kMostOfLog, static_cast<double>(of_kind[k].size())) *
                         (logs_[log].simulated && recorded_ ? kSimulatedShare : 1);
      addPart(of_kind[k], k, say);
      sum[k] += say;
    }
  }
  double all = 0;
  for (const Part& p : parts) all += p.say / std::sqrt(sum[p.kind]);
  for (const Part& p : parts) {
    const double weight = p.say / std::sqrt(sum[p.kind]) / all *
                          static_cast<double>(training.size()) /
                          static_cast<double>(p.end - p.begin);  // 1 on average
    for (std::size_t i = p.begin; i < p.end; ++i) training[i].weight = weight;
  }
  TreeTrainingParams params;
  params.seed = seed_;
  return trainTrees(training, params);
}

const std::vector<ClusterTrainer::Probabilities>& ClusterTrainer::leftOut(std::size_t log,
                                                                          std::size_t without) {
  // Trees without two logs serve both.
  if (!left_out_[log][without].empty()) return left_out_[log][without];
  const BoostedTrees trees = train(log, without);
  const auto judge = [&](std::size_t of, std::size_t other) {
    left_out_[of][other].clear();
    for (const std::size_t i : of_log_[of])
      left_out_[of][other].push_back(softmax(trees, samples_.clusters[i].descriptor));
  };
  judge(log, without);
  if (without < logs_.size() && without != log) judge(without, log);
  return left_out_[log][without];
}

ClusterClassifier ClusterTrainer::classifier(std::size_t without, Provenance provenance) {
  std::array<std::vector<double>, kClusterKinds> values;
  std::array<std::vector<bool>, kClusterKinds> is_kind;
  std::vector<double> weights;
  std::array<double, kClusterKinds> prior{};
  double all = 0;
  for (std::size_t log = 0; log < logs_.size(); ++log) {
    if (log == without || (recorded_ && logs_[log].simulated)) continue;
    const auto& raw = leftOut(log, without);
    const double weight = 1 / std::sqrt(std::max(1.0, static_cast<double>(of_log_[log].size())));
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const auto kind = samples_.clusters[of_log_[log][i]].kind;
      if (!kind) continue;
      weights.push_back(weight);
      prior[static_cast<std::size_t>(*kind)] += weight, all += weight;
      for (std::size_t k = 0; k < kClusterKinds; ++k) {
        values[k].push_back(raw[i][k]);
        is_kind[k].push_back(k == static_cast<std::size_t>(*kind));
      }
    }
  }
  std::array<Calibration, kClusterKinds> calibrations;
  for (std::size_t k = 0; k < kClusterKinds; ++k) {
    const auto n = static_cast<double>(std::count(is_kind[k].begin(), is_kind[k].end(), true));
    const double share = n / (n + kFewSamples);
    if (!recorded_ || k != static_cast<std::size_t>(ClusterKind::kPhantom))
      calibrations[k].knots = isotonic(values[k], is_kind[k], weights);
    for (Knot& knot : calibrations[k].knots)
      knot.calibrated = share * knot.calibrated + (1 - share) * knot.raw;
    prior[k] = (prior[k] + 0.002 * all) / (all * (1 + 0.002 * kClusterKinds));
  }
  ClusterClassifier shape(train(without, without), calibrations, prior, EvidenceMemory{},
                          provenance);
  const EvidenceMemory memory = memoryOf(shape, without);
  return ClusterClassifier(shape.trees(), calibrations, prior, memory, std::move(provenance),
                           shapeExamples(samples_, logs_, without));
}

/// From evidence of logs that the trees had not seen: of a road user for its own kind, of a thing
/// for the likeliest road user.
EvidenceMemory ClusterTrainer::memoryOf(const ClusterClassifier& shape, std::size_t without) {
  std::vector<std::size_t> of;
  std::vector<double> evidence;
  constexpr auto kThing = static_cast<std::size_t>(ClusterKind::kThing);
  for (std::size_t log = 0; log < logs_.size(); ++log) {
    if (log == without || (recorded_ && logs_[log].simulated)) continue;
    const auto& raw = leftOut(log, without);
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const ClusterSample& s = samples_.clusters[of_log_[log][i]];
      if (!s.kind || s.object == ClusterSample::kNoObject || s.whole >= 0) continue;
      const auto calibrated = [&](std::size_t k) {
        return 0.9 * shape.calibrations()[k](raw[i][k]) + 0.1 * raw[i][k] + 1e-4;
      };
      const auto own = static_cast<std::size_t>(*s.kind);
      if (own > kThing) continue;
      const double value =
          own < kThing ? calibrated(own) : std::max({calibrated(0), calibrated(1), calibrated(2)});
      of.push_back(of_log_[log][i]);
      evidence.push_back(std::clamp(std::log(value / calibrated(kThing)), -6.0, 6.0));
    }
  }
  return fitMemory(samples_, of, std::move(evidence));
}

namespace {

/// Subtracts the mean over the samples of a kind in a log and divides by their deviation.
void standardize(const ClusterSamples& samples, const std::vector<std::size_t>& of,
                 std::vector<double>& values) {
  struct Sums {
    double n = 0, sum = 0, squares = 0;
  };
  std::map<std::pair<std::size_t, ClusterKind>, Sums> groups;
  const auto groupOf = [&](std::size_t i) -> Sums& {
    const ClusterSample& s = samples.clusters[of[i]];
    return groups[{s.log, *s.kind}];
  };
  for (std::size_t i = 0; i < of.size(); ++i) {
    Sums& g = groupOf(i);
    g.n += 1, g.sum += values[i], g.squares += values[i] * values[i];
  }
  for (std::size_t i = 0; i < of.size(); ++i) {
    const Sums& g = groupOf(i);
    const double mean = g.sum / g.n;
    values[i] = (values[i] - mean) / std::sqrt(std::max(1e-6, g.squares / g.n - mean * mean));
  }
}

/// Two views of one object.
struct ViewPair {
  double bearing, log_range, seconds, product, weight;
};

std::vector<ViewPair> viewPairs(const ClusterSamples& samples, const std::vector<std::size_t>& of,
                                const std::vector<double>& values) {
  constexpr double kLongest = 4;  // [s]
  std::map<std::pair<std::size_t, std::int64_t>, std::vector<std::size_t>> views;
  for (std::size_t i = 0; i < of.size(); ++i)
    views[{samples.clusters[of[i]].log, samples.clusters[of[i]].object}].push_back(i);
  std::vector<ViewPair> pairs;
  for (const auto& [object, indices] : views) {
    const double weight = 1 / std::sqrt(static_cast<double>(indices.size()));
    for (std::size_t a = 0; a < indices.size(); ++a) {
      for (std::size_t b = a + 1; b < indices.size(); ++b) {
        const ClusterSample &p = samples.clusters[of[indices[a]]],
                            &q = samples.clusters[of[indices[b]]];
        const double seconds = std::abs(q.t - p.t);
        if (seconds <= 0 || seconds > kLongest) continue;
        pairs.push_back({std::abs(wrapAngle(q.view.bearing - p.view.bearing)),
                         std::abs(q.view.log_range - p.view.log_range), seconds,
                         values[indices[a]] * values[indices[b]], weight});
      }
    }
  }
  constexpr std::size_t kMostPairs = 40000;
  const std::size_t stride = 1 + pairs.size() / kMostPairs;
  for (std::size_t i = 0; i * stride < pairs.size(); ++i) pairs[i] = pairs[i * stride];
  pairs.resize((pairs.size() + stride - 1) / stride);
  return pairs;
}

}  // namespace

EvidenceMemory fitMemory(const ClusterSamples& samples, const std::vector<std::size_t>& of,
                         std::vector<double> evidence) {
  standardize(samples, of, evidence);
  const std::vector<ViewPair> pairs = viewPairs(samples, of, evidence);
  EvidenceMemory best;
  constexpr std::size_t kEnough = 200;
  if (pairs.size() < kEnough) return best;
  double least = std::numeric_limits<double>::infinity();
  for (const double kept : {0.5, 0.7, 0.8, 0.9})
    for (const double bearing : {0.1, 0.3, 1.0})
      for (const double log_range : {0.1, 0.3, 1.0})
        for (const double time : {0.3, 1.0, 3.0}) {
          const EvidenceMemory shape{0, kept, bearing, log_range, time, best.renewal};
          // The correlation is lasting + (1 - lasting) c: linear in lasting.
          double numerator = 0, denominator = 1e-12;
          std::vector<double> c(pairs.size());
          for (std::size_t i = 0; i < pairs.size(); ++i) {
            const ViewPair& p = pairs[i];
            c[i] = shape.correlation({0, 0}, {p.bearing, p.log_range}, p.seconds);
            numerator += p.weight * (p.product - c[i]) * (1 - c[i]);
            denominator += p.weight * (1 - c[i]) * (1 - c[i]);
          }
          const double lasting = std::clamp(numerator / denominator, 0.0, 0.95);
          double loss = 0;
          for (std::size_t i = 0; i < pairs.size(); ++i) {
            const double rest = pairs[i].product - lasting - (1 - lasting) * c[i];
            loss += pairs[i].weight * rest * rest;
          }
          if (loss >= least) continue;
          least = loss;
          best = {lasting, kept, bearing, log_range, time, best.renewal};
        }
  return best;
}

}  // namespace perception
