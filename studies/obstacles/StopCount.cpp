#include "studies/obstacles/StopCount.h"

namespace perception {
namespace {

constexpr double kOneStop = 0.5;  // [s]

}  // namespace

void StopCount::count(Runs& runs, std::optional<Stamp>& last, Stamp stamp) {
  ++runs.scans;
  if (!last || stamp - *last > kOneStop) ++runs.stops;
  last = stamp;
}

void StopCount::add(Stamp stamp, bool stop, InTheWay real) {
  if (stop && real == InTheWay::kYes) count(rightly, last_rightly_, stamp);
  if (stop && real == InTheWay::kNo) count(falsely, last_falsely_, stamp);
  if (!stop && real == InTheWay::kYes) count(missed, last_missed_, stamp);
}

StopCount& StopCount::operator+=(const StopCount& other) {
  const auto add = [](Runs& a, const Runs& b) { a.scans += b.scans, a.stops += b.stops; };
  add(rightly, other.rightly);
  add(falsely, other.falsely);
  add(missed, other.missed);
  return *this;
}

}  // namespace perception
