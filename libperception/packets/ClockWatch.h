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

/// Watches one device's clock.
class ClockWatch {
 public:
  /// What changed, for the user; empty for most packets. Packets of a device that sends no stamps
  /// have 0.
  std::optional<std::string> add(const DecodedPacket& packet, Stamp received);
  ClockLedger ledger() const;

 private:
  std::deque<double> offsets_;  ///< [s]
  std::optional<std::int64_t> last_ns_, last_received_ns_;
  ClockState state_ = ClockState::kUntold;
  bool begun_ = false;
  std::uint64_t steps_ = 0;
};

}  // namespace perception
