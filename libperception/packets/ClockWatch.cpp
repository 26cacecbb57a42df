#include "libperception/packets/ClockWatch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace perception {
namespace {

constexpr std::size_t kNewest = 101;
/// [s] Between two packets the clocks may differ by as much: what waits in a computer's buffers.
constexpr double kStep = 0.25;

/// [s] within half a period
double difference(std::int64_t ns, std::int64_t period) {
  if (period > 0) {
    ns %= period;
    if (ns > period / 2) ns -= period;
    if (ns < -period / 2) ns += period;
  }
  return static_cast<double>(ns) * 1e-9;
}

}  // namespace

std::optional<std::string> ClockWatch::add(const DecodedPacket& packet, Stamp received) {
  std::optional<std::string> change;
  if (packet.clock != ClockState::kUntold && packet.clock != state_) {
    if (begun_ || packet.clock != ClockState::kSynchronized)
      change = std::string("its clock: ") + nameOf(packet.clock);
    state_ = packet.clock;
    begun_ = true;
  }
  if (packet.stamp_ns == 0) return change;
  const double offset = difference(received.ns - packet.stamp_ns, packet.clock_period_ns);
  if (last_ns_) {
    const double passed = difference(packet.stamp_ns - *last_ns_, packet.clock_period_ns);
    const double here = static_cast<double>(received.ns - *last_received_ns_) * 1e-9;
    if (std::abs(passed - here) > kStep) {
      ++steps_;
      offsets_.clear();
      char text[80];
      std::snprintf(text, sizeof text, "its clock was set by %+.3f s", passed - here);
      change = text;
    }
  }
  last_ns_ = packet.stamp_ns;
  last_received_ns_ = received.ns;
  offsets_.push_back(offset);
  if (offsets_.size() > kNewest) offsets_.pop_front();
  return change;
}

ClockLedger ClockWatch::ledger() const {
  ClockLedger ledger{state_, {}, steps_};
  if (offsets_.empty()) return ledger;
  std::vector<double> sorted(offsets_.begin(), offsets_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  ledger.offset = *middle;
  return ledger;
}

}  // namespace perception
