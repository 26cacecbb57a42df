#include "studies/obstacles/ObstacleVerdict.h"

#include <algorithm>
#include <cmath>

namespace perception {

double nearestTen(std::vector<double> distances) {
  constexpr std::size_t kTen = 10;
  constexpr double kTogetherWithin = 0.5;  // [m]
  std::sort(distances.begin(), distances.end());
  for (std::size_t i = 0; i + kTen <= distances.size(); ++i)
    if (distances[i + kTen - 1] - distances[i] <= kTogetherWithin) return distances[i];
  return ObstacleMoment::kNone;
}

void ObstacleVerdict::add(const ObstacleMoment& moment) {
  ++scenes;
  needed = moment.needed;
  const bool free = demand_ == ShapeDemand::kPass || moment.gap > moment.needed + kBorder;
  addShown(moment);
  for (std::size_t k = 0; k < kStopCallers; ++k) {
    calls_[k].stops.add(moment.stamp, moment.stops[k], free ? InTheWay::kNo : InTheWay::kPerhaps);
    if (moment.stops[k] && !free && !std::isfinite(calls_[k].called_at))
      calls_[k].called_at = moment.gap;
  }
}

// Before the calls of this scene are entered: a caller is silent until it has called.
void ObstacleVerdict::addShown(const ObstacleMoment& moment) {
  if (!std::isfinite(moment.shown)) return;
  if (!std::isfinite(shown_at)) shown_at = moment.gap;
  const auto within = [&](double distance) { return distance + kTolerance <= moment.needed; };
  if (demand_ != ShapeDemand::kStop || !within(moment.shown)) return;
  ++shown_within_;
  for (std::size_t k = 0; k < kStopCallers; ++k)
    calls_[k].silent += !moment.stops[k] && !std::isfinite(calls_[k].called_at);
  const Calls& advice = of(StopCaller::kAdvice);
  const auto own = static_cast<std::size_t>(StopCaller::kAdvice);
  if (moment.stops[own] || std::isfinite(advice.called_at)) return;
  const SilenceCause cause = !within(moment.standing) ? SilenceCause::kHeight
                             : !within(moment.told)   ? SilenceCause::kGround
                                                      : SilenceCause::kDoubt;
  ++silent_by_cause[static_cast<std::size_t>(cause)];
}

bool ObstacleVerdict::done() const {
  return demand_ == ShapeDemand::kStop && shownWithin() &&
         std::all_of(calls_.begin(), calls_.end(),
                     [](const Calls& c) { return std::isfinite(c.called_at); });
}

bool ObstacleVerdict::missed(StopCaller caller) const {
  return shownWithin() && !std::isfinite(of(caller).called_at);
}

bool ObstacleVerdict::late(StopCaller caller, std::size_t allowed) const {
  return std::isfinite(of(caller).called_at) && of(caller).silent > allowed;
}

}  // namespace perception
