#include "studies/weather/TrustScore.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libperception/calibration/clusters/PointLabels.h"

namespace perception {
namespace {

constexpr int kReliabilityBins = 10;

std::optional<double> returnShareOf(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::string nameOfPhantom(std::uint16_t label) {
  switch (label) {
    case 110:
      return "snow";
    case 112:
      return "rain";
    case 113:
      return "fog";
    case 114:
      return "spray";
    case 115:
      return "exhaust";
    case 116:
      return "mirror";
    case 117:
      return "noise";
    default:
      return fmt::format("{}", label);
  }
}

void TrustHistogram::add(float trust) {
  const int bin = std::clamp(static_cast<int>(static_cast<double>(trust) * kBins), 0, kBins - 1);
  ++count_[static_cast<std::size_t>(bin)];
  doubt_[static_cast<std::size_t>(bin)] += 1 - static_cast<double>(trust);
  ++total_;
}

TrustHistogram& TrustHistogram::operator+=(const TrustHistogram& other) {
  for (std::size_t b = 0; b < count_.size(); ++b)
    count_[b] += other.count_[b], doubt_[b] += other.doubt_[b];
  total_ += other.total_;
  return *this;
}

std::size_t TrustHistogram::below(double trust) const {
  return countBetween(0, static_cast<int>(std::lround(trust * kBins)));
}

std::size_t TrustHistogram::countBetween(int from, int to) const {
  std::size_t sum = 0;
  for (int b = from; b < to; ++b) sum += count_[static_cast<std::size_t>(b)];
  return sum;
}

double TrustHistogram::sumBetween(int from, int to) const {
  double sum = 0;
  for (int b = from; b < to; ++b) sum += doubt_[static_cast<std::size_t>(b)];
  return sum;
}

void TrustScore::add(float trust, std::uint16_t label) { by_label_[label].add(trust); }

void TrustScore::add(const std::vector<float>& trust, const std::vector<std::uint16_t>& labels) {
  for (std::size_t i = 0; i < labels.size(); ++i) add(trust[i], labels[i]);
}

TrustHistogram TrustScore::surfaces() const {
  TrustHistogram sum;
  for (const auto& [label, counts] : by_label_)
    if (!isPhantomLabel(label) && (label != 0 || unlabeled_is_surface)) sum += counts;
  return sum;
}

TrustHistogram TrustScore::phantoms() const {
  TrustHistogram sum;
  for (const auto& [label, counts] : by_label_)
    if (isPhantomLabel(label)) sum += counts;
  return sum;
}

TrustScore::Rates TrustScore::at(double threshold, std::uint16_t kind) const {
  const TrustHistogram wrong = surfaces();
  const auto own = by_label_.find(kind);
  const TrustHistogram right = kind == 0                ? phantoms()
                               : own == by_label_.end() ? TrustHistogram()
                                                        : own->second;
  Rates r;
  r.found = right.below(threshold);
  r.false_alarms = wrong.below(threshold);
  r.missed = right.total() - r.found;
  r.precision = returnShareOf(r.found, r.found + r.false_alarms);
  r.recall = returnShareOf(r.found, right.total());
  if (right.total() > 0) r.f1 = returnShareOf(2 * r.found, 2 * r.found + r.false_alarms + r.missed);
  return r;
}

std::optional<double> TrustScore::averagePrecision() const {
  const TrustHistogram right = phantoms(), wrong = surfaces();
  if (right.total() == 0) return std::nullopt;
  double sum = 0;
  std::size_t found = 0, all = 0;
  for (int b = 0; b < TrustHistogram::kBins; ++b) {
    const std::size_t here = right.countBetween(b, b + 1);
    found += here;
    all += here + wrong.countBetween(b, b + 1);
    if (here > 0)
      sum += static_cast<double>(here) * static_cast<double>(found) / static_cast<double>(all);
  }
  return sum / static_cast<double>(right.total());
}

std::vector<TrustScore::Bin> TrustScore::reliability() const {
  const TrustHistogram right = phantoms(), wrong = surfaces();
  std::vector<Bin> bins;
  constexpr int kWidth = TrustHistogram::kBins / kReliabilityBins;
  for (int b = kReliabilityBins - 1; b >= 0; --b) {
    const int from = b * kWidth, to = from + kWidth;
    const std::size_t phantom = right.countBetween(from, to);
    const std::size_t all = phantom + wrong.countBetween(from, to);
    if (all == 0) continue;
    const auto n = static_cast<double>(all);
    bins.push_back({(right.sumBetween(from, to) + wrong.sumBetween(from, to)) / n,
                    static_cast<double>(phantom) / n, all});
  }
  return bins;
}

std::optional<double> TrustScore::calibrationError() const {
  double sum = 0, n = 0;
  for (const Bin& bin : reliability()) {
    sum += static_cast<double>(bin.returns) * std::abs(bin.stated - bin.phantoms);
    n += static_cast<double>(bin.returns);
  }
  if (n <= 0) return std::nullopt;
  return sum / n;
}

}  // namespace perception
