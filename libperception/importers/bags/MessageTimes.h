#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"

namespace perception {

/// When a message was measured, as it says itself, and when it was recorded.
struct MessageTimes {
  Stamp measured;  ///< not behind 1970: it does not say
  Stamp recorded;
  bool says() const { return measured.ns > 0; }
};

/// Which messages of one source are used, and by which clock.
struct MessageClock {
  std::vector<bool> used;       ///< of each message, in order of the recording
  std::uint64_t left_out = 0;   ///< messages whose stamps do not go on from those before
  double farthest = 0;          ///< [s] by which their stamps are off, at most
  std::uint64_t unstamped = 0;  ///< messages without a stamp of their own
  /// [s] from recording to measurement, where it stays the same within a second: median.
  std::optional<double> lead;
  double shift = 0;   ///< [s] to be added to the stamps
  double resent = 0;  ///< [s] see resentWithin()

  bool uses(std::size_t message) const { return message >= used.size() || used[message]; }
};

/// Stamps that go back are left out until they pass the newest one before, so that all sources of a
/// recording keep the same part of it; so are up to ten stamps that jump ahead by a second or more
/// and come back. A message that was recorded late, within a second, is used: it fits into a gap
/// between the others.
MessageClock clockOf(const std::vector<MessageTimes>& times);

/// [s] A lidar's scan that comes again within this time was sent again: 20 ms, before a lidar can
/// have turned once more (assumed). 0 where messages follow each other as closely as that, as do
/// the parts of a turn or the repetitions of a scan that is shown as a world that stands: then none
/// was.
double resentWithin(std::vector<Stamp> stamps);

/// Where the clocks of sources differ by more than a second: sets `shift` of those that are a
/// second ahead of the recording, or two behind it (less can be a delay), to the recording's time.
void alignClocks(std::map<std::string, MessageClock>& clocks);

/// What was left out or moved, a line each.
std::vector<std::string> faultsOf(const std::string& source, const MessageClock& clock);

}  // namespace perception
