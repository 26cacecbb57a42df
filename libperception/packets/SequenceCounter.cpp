#include <algorithm>

#include "libperception/packets/Decoder.h"

namespace perception {
namespace {

constexpr std::uint64_t kWindow = 1024;  ///< what is further back is a new beginning
constexpr std::uint64_t kShort = 256;    ///< numbers that run to 255: too few to tell a restart
constexpr std::size_t kListed = 1000;

std::uint64_t identityOf(const DecodedPacket& packet) {
  return packet.identity != 0 ? packet.identity : static_cast<std::uint64_t>(packet.stamp_ns);
}

}  // namespace

void SequenceCounter::beginAt(const DecodedPacket& packet) {
  // So that what was sent before it has a number, too; after the numbers of the time before.
  const std::uint64_t turns = last_ ? *last_ / packet.numbers + 2 : 1;
  last_ = *packet.number + turns * packet.numbers;
  seen_.assign(kWindow, {0, 0});
  remember(*last_, packet);
}

void SequenceCounter::remember(std::uint64_t number, const DecodedPacket& packet) {
  seen_[number % kWindow] = {number, identityOf(packet)};
}

/// Whether the number came before, with another stamp.
bool SequenceCounter::isAnotherOf(std::uint64_t number, const DecodedPacket& packet) const {
  const auto& [seen, identity] = seen_[number % kWindow];
  return seen == number && identity != identityOf(packet);
}

bool SequenceCounter::count(const DecodedPacket& packet) {
  ++ledger_.received;
  if (!packet.number || packet.numbers == 0) return true;
  numbers_ = packet.numbers;
  if (!last_) {
    beginAt(packet);
    return true;
  }
  const std::uint64_t window = std::min(kWindow, packet.numbers / 4);
  const std::uint64_t step =
      (*packet.number + packet.numbers - *last_ % packet.numbers) % packet.numbers;
  const std::uint64_t back = (packet.numbers - step) % packet.numbers;
  const bool onward = step != 0 && back > window;
  // Numbers that hold for long never go on by half of them.
  const bool far_back = onward && packet.numbers > kShort && step > packet.numbers / 2;
  if (far_back || (!onward && isAnotherOf(*last_ - back, packet))) {
    ++ledger_.restarts;
    beginAt(packet);
    return true;
  }
  if (onward) {
    if (step > 1) addGap(*last_ + 1, *last_ + step - 1);
    ledger_.lost += step - 1;
    *last_ += step;
    remember(*last_, packet);
    return true;
  }
  return countEarlier(*last_ - back, packet);
}

/// A day of losses does not fill the memory: of those that no late packet can fill any more, the
/// first ones are kept.
void SequenceCounter::addGap(std::uint64_t from, std::uint64_t to) {
  gaps_.emplace_back(from, to);
  if (gaps_.size() < 2 * (kListed + kWindow)) return;
  gaps_.erase(gaps_.begin() + kListed, gaps_.end() - kWindow);
}

/// One that fills a gap, or one that came before.
bool SequenceCounter::countEarlier(std::uint64_t number, const DecodedPacket& packet) {
  for (std::size_t i = gaps_.size(); i-- > 0;) {
    const auto [from, to] = gaps_[i];
    if (number > to) break;
    if (number < from) continue;
    gaps_.erase(gaps_.begin() + static_cast<std::ptrdiff_t>(i));
    if (number < to) gaps_.insert(gaps_.begin() + static_cast<std::ptrdiff_t>(i), {number + 1, to});
    if (from < number)
      gaps_.insert(gaps_.begin() + static_cast<std::ptrdiff_t>(i), {from, number - 1});
    --ledger_.lost;
    ++ledger_.late;
    remember(number, packet);
    return true;
  }
  ++ledger_.repeated;
  return false;
}

std::vector<std::string> SequenceCounter::lostRanges() const {
  std::vector<std::string> ranges;
  const auto shown = [&](std::uint64_t number) {
    return std::to_string(numbers_ > kShort ? number % numbers_ : number - numbers_);
  };
  for (const auto& [from, to] : gaps_) {
    if (ranges.size() == kListed) break;
    ranges.push_back(from == to ? shown(from) : shown(from) + "-" + shown(to));
  }
  return ranges;
}

const char* nameOf(ClockState state) {
  switch (state) {
    case ClockState::kNeverSet:
      return "never set";
    case ClockState::kSynchronized:
      return "synchronized";
    case ClockState::kLost:
      return "synchronization lost";
    case ClockState::kUntold:
      break;
  }
  return "not told";
}

}  // namespace perception
