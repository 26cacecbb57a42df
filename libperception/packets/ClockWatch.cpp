#include "libperception/packets/ClockWatch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "libperception/core/math/Median.h"

namespace perception {
namespace {

constexpr std::size_t kNewest = 101;
/// [s] What waits in a computer's buffers, and how long a clock must be late to be taken as set.
constexpr double kStep = 0.25, kLateFor = 1;
constexpr std::size_t kFew = 20;  // packets: the first ones may all be late

/// [s] within half a period
double difference(std::int64_t ns, std::int64_t period) {
  if (period > 0) {
    ns %= period;
    if (ns > period / 2) ns -= period;
    if (ns < -period / 2) ns += period;
  }
  return static_cast<double>(ns) * 1e-9;
}

std::string joined(const std::optional<std::string>& first, const std::string& second) {
  return first ? *first + "; " + second : second;
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
  Offset now{received, difference(received.ns - packet.stamp_ns, packet.clock_period_ns)};
  if (offsets_.empty()) {
    offsets_.push_back(now);
    return change;
  }
  const auto least = [](const std::deque<Offset>& offsets) {
    return std::min_element(offsets.begin(), offsets.end(),
                            [](const Offset& a, const Offset& b) { return a.seconds < b.seconds; })
        ->seconds;
  };
  const double usual = least(offsets_);
  const auto more = static_cast<std::int64_t>(std::llround((now.seconds - usual) * 1e9));
  now.seconds = usual + difference(more, packet.clock_period_ns);
  if (now.seconds > usual + kStep) {
    late_.push_back(now);
    if (late_.size() < kFew || received - late_.front().received < kLateFor) return change;
    const double step = least(late_) - usual;
    return joined(change, begin(std::exchange(late_, {}), step));
  }
  late_.clear();
  if (now.seconds < usual - kStep) {
    if (offsets_.size() >= kFew) return joined(change, begin({now}, now.seconds - usual));
    offsets_.clear();
  }
  offsets_.push_back(now);
  if (offsets_.size() > kNewest) offsets_.pop_front();
  return change;
}

std::string ClockWatch::begin(std::deque<Offset> offsets, double change) {
  ++steps_;
  offsets_ = std::move(offsets);
  char text[80];
  std::snprintf(text, sizeof text, "its clock was set by %+.3f s", -change);
  return text;
}

ClockLedger ClockWatch::ledger() const {
  ClockLedger ledger{state_, {}, steps_};
  if (offsets_.empty()) return ledger;
  std::vector<double> offsets;
  for (const Offset& offset : offsets_) offsets.push_back(offset.seconds);
  ledger.offset = medianOf(std::move(offsets));
  return ledger;
}

}  // namespace perception
