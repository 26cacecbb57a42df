#include "libperception/pipeline/health/ReturnRate.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

// All assumed.
constexpr double kFewReturns = 0.05;               // of the usual ones
constexpr double kNoReturns = 20;                  // of a lidar of which nothing is known
constexpr double kUsualOver = 5;                   // [s] memory
constexpr double kBlind = 1, kBlindFromStart = 3;  // [s] of empty scans
constexpr std::size_t kLeastScans = 5;             // of them
const double kLogHalf = std::log(0.5);
constexpr double kLeastSigma = 0.15;  // of the logarithm of the road's returns
constexpr double kMostRatio = 10;     // log-likelihood ratio of one scan
constexpr double kAlike = 1;          // [s] in which scans show the same road
constexpr double kKnownFrom = 2;      // [s] of road

}  // namespace

void ReturnRate::add(std::size_t returns, Stamp stamp) {
  const auto count = static_cast<double>(returns);
  last_ = stamp;
  if (usual_ > 0 ? count < kFewReturns * usual_ : count < kNoReturns) {
    if (!empty_since_) empty_since_ = stamp;
    ++empty_scans_;
    return;
  }
  usual_ += (usual_ > 0 ? 0.1 / kUsualOver : 1) * (count - usual_);
  empty_since_.reset();
  empty_scans_ = 0;
}

std::optional<double> ReturnRate::blindFor() const {
  if (!empty_since_ || empty_scans_ < kLeastScans) return std::nullopt;
  const double empty = last_ - *empty_since_;
  if (empty < (usual_ > 0 ? kBlind : kBlindFromStart)) return std::nullopt;
  return empty;
}

void ReturnRate::addRoad(std::size_t returns, Stamp stamp) {
  const double now = std::log(0.5 + static_cast<double>(returns));
  if (!first_road_) {
    if (static_cast<double>(returns) < kNoReturns) return;
    first_road_ = last_road_ = stamp;
    log_usual_ = now;
  }
  const double dt = std::clamp(stamp - last_road_, 0.0, kAlike);
  last_road_ = stamp;
  const double change = now - log_usual_;
  left_ = std::exp(change);
  const double variance = std::max(variance_, kLeastSigma * kLeastSigma);
  const double ratio = (change * kLogHalf - kLogHalf * kLogHalf / 2) / variance;
  if (stamp - *first_road_ >= kKnownFrom)
    lost_ = std::max(0.0, lost_ + dt / kAlike * std::clamp(ratio, -kMostRatio, kMostRatio));
  if (lost_ > 0) return;
  const double keep = std::exp(-dt / kUsualOver);
  log_usual_ += (1 - keep) * change;
  variance_ = keep * variance_ + (1 - keep) * change * change;
}

}  // namespace perception
