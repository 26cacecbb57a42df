#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/packets/ClockWatch.h"
#include "libperception/packets/Decoder.h"

namespace perception {

class DeviceSimulator;

/// A driver that can end without loss, and that counts what it has received.
class LedgerSource {
 public:
  virtual ~LedgerSource() = default;
  /// Receives the data that are under way, and nothing after that. The next doProcess() outputs the
  /// last frame.
  virtual void endCapture() = 0;
  virtual PacketLedger packets() const = 0;
  virtual std::vector<std::string> lostPackets() const = 0;
  virtual std::vector<std::string> warnings() const = 0;
  /// What the user should know and is no fault, a line each.
  virtual std::vector<std::string> notes() const { return {}; }
  /// Packets that were refused since they came from another sender than the device.
  virtual std::uint64_t refused() const { return 0; }
  /// Packets that the kernel had no room for.
  virtual std::uint64_t overrun() const { return 0; }
  virtual ClockLedger clock() const { return {}; }
  /// Of the device simulator; null without one.
  virtual const DeviceSimulator* simulator() const = 0;
};

}  // namespace perception
