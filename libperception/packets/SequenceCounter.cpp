#include "libperception/packets/Decoder.h"

namespace perception {
namespace {

constexpr std::uint64_t kWindow = 1024;  ///< what is further back is a new beginning
constexpr std::size_t kListed = 1000;

}  // namespace

bool SequenceCounter::count(const DecodedPacket& packet) {
  ++ledger_.received;
  if (!packet.number || packet.numbers == 0) return true;
  numbers_ = packet.numbers;
  const std::uint64_t window = std::min(kWindow, packet.numbers / 4);
  if (!last_) {
    last_ = *packet.number + packet.numbers;  // so that what was sent before it has a number, too
    return true;
  }
  const std::uint64_t step =
      (*packet.number + packet.numbers - *last_ % packet.numbers) % packet.numbers;
  const std::uint64_t back = (packet.numbers - step) % packet.numbers;
  if (step != 0 && back > window) {
    if (step > 1) gaps_.emplace_back(*last_ + 1, *last_ + step - 1);
    ledger_.lost += step - 1;
    *last_ += step;
    return true;
  }
  const std::uint64_t number = *last_ - back;
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
    return true;
  }
  ++ledger_.repeated;
  return false;
}

std::vector<std::string> SequenceCounter::lostRanges() const {
  std::vector<std::string> ranges;
  for (const auto& [from, to] : gaps_) {
    if (ranges.size() == kListed) break;
    const std::string first = std::to_string(from % numbers_);
    ranges.push_back(from == to ? first : first + "-" + std::to_string(to % numbers_));
  }
  return ranges;
}

}  // namespace perception
