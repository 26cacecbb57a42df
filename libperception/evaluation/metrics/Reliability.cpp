#include <algorithm>
#include <array>
#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/metrics/Metrics.h"

namespace perception {
namespace {

constexpr std::size_t kBins = 10;

// Sorts stated probabilities into bins of equal width.
class ReliabilityBuilder {
 public:
  void add(double probability, bool right) {
    const double place = std::max(probability, 0.0) * static_cast<double>(kBins);
    Bin& bin = bins_[std::min(static_cast<std::size_t>(place), kBins - 1)];
    bin.stated += probability;
    bin.right += right ? 1.0 : 0.0;
    ++bin.count;
  }

  Reliability finish() const {
    Reliability result;
    double error = 0, total = 0;
    for (std::size_t b = 0; b < kBins; ++b) {
      ReliabilityBin bin;
      bin.low = static_cast<double>(b) / kBins;
      bin.high = static_cast<double>(b + 1) / kBins;
      bin.count = bins_[b].count;
      const auto n = static_cast<double>(bin.count);
      if (bin.count) {
        bin.mean_probability = bins_[b].stated / n;
        bin.correct = bins_[b].right / n;
        error += n * std::abs(*bin.mean_probability - *bin.correct);
      }
      total += n;
      result.bins.push_back(bin);
    }
    if (total > 0) result.calibration_error = error / total;
    return result;
  }

 private:
  struct Bin {
    double stated = 0, right = 0;  // sums
    std::size_t count = 0;
  };
  std::array<Bin, kBins> bins_;
};

}  // namespace

Reliability reliability(const Evaluation& evaluation, Pairing pairing) {
  ReliabilityBuilder builder;
  for (const TruthSample& sample : evaluation.samples) {
    const auto& match = sample.matched(pairing);
    if (match) builder.add(match->probability, match->class_id == sample.class_id);
  }
  return builder.finish();
}

bool movesSo(const TruthSample& sample, TruthMotion motion) {
  if (motion == TruthMotion::kAny) return true;
  return sample.speed && (*sample.speed < kStandingSpeed) == (motion == TruthMotion::kStanding);
}

Reliability frontReliability(const Evaluation& evaluation, Pairing pairing, ClassId class_id,
                             TruthMotion motion) {
  ReliabilityBuilder builder;
  for (const TruthSample& sample : evaluation.samples) {
    const auto& match = sample.matched(pairing);
    if (!match || !match->heading_error || !movesSo(sample, motion) ||
        (class_id >= 0 && sample.class_id != class_id))
      continue;
    builder.add(match->front_probability, std::abs(*match->heading_error) <= kPi / 2);
  }
  return builder.finish();
}

FrontFigures frontFigures(const Evaluation& evaluation, Pairing pairing, ClassId class_id,
                          TruthMotion motion) {
  FrontFigures f;
  std::size_t known_reversed = 0, other_reversed = 0;
  for (const TruthSample& sample : evaluation.samples) {
    const auto& match = sample.matched(pairing);
    if (!match || !movesSo(sample, motion) || (class_id >= 0 && sample.class_id != class_id))
      continue;
    ++f.matched;
    if (!match->heading_error) continue;
    ++f.headings;
    const bool known = match->front_probability >= kSureFront;
    f.known += known;
    if (std::abs(*match->heading_error) > kPi / 2) ++(known ? known_reversed : other_reversed);
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole ? Figure(static_cast<double>(part) / static_cast<double>(whole)) : Figure();
  };
  f.with_heading = share(f.headings, f.matched);
  f.front_known = share(f.known, f.matched);
  f.known_reversed = share(known_reversed, f.known);
  f.other_reversed = share(other_reversed, f.headings - f.known);
  f.calibration_error = frontReliability(evaluation, pairing, class_id, motion).calibration_error;
  return f;
}

Reliability existenceReliability(const Evaluation& evaluation) {
  ReliabilityBuilder builder;
  for (const ExistenceSample& sample : evaluation.existence)
    builder.add(sample.probability, sample.real);
  return builder.finish();
}

}  // namespace perception
