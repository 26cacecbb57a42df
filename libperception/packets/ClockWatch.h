#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/packets/Decoder.h"

namespace perception {

/// A device's clock beside this computer's.
struct ClockLedger {
  ClockState state = ClockState::kUntold;  ///< as the newest packet says
  /// [s] Reception minus the device's stamp: offset of the clocks and transport; the median of the
  /// newest 101 packets, of clocks that begin anew every hour within half an hour. Empty: the
  /// device sends no stamps.
  std::optional<double> offset;
  std::uint64_t steps = 0;  ///< times that the device's clock was set
};

/// Watches one device's clock. A packet that comes late makes the offset greater for a moment, a
/// clock that is set changes it for good: smaller at once, greater if it stays so for a second.
class ClockWatch {
 public:
  /// What changed, for the user; empty for most packets. Packets of a device that sends no stamps
  /// have 0.
  std::optional<std::string> add(const DecodedPacket& packet, Stamp received);
  ClockLedger ledger() const;

 private:
  struct Offset {
    Stamp received;
    double seconds = 0;  ///< without jumps at the end of the clock's period
  };
  /// The newest offsets from now on; says by how much the clock was set.
  std::string begin(std::deque<Offset> offsets, double change);

  std::deque<Offset> offsets_, late_;  ///< of late packets, until it is known what they are
  ClockState state_ = ClockState::kUntold;
  bool begun_ = false;
  std::uint64_t steps_ = 0;
};

}  // namespace perception
