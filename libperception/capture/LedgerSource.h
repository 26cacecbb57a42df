#pragma once
#include <string>
#include <vector>

#include "libperception/packets/Decoder.h"

namespace perception {

class PacketReplay;

/// A driver that can end without loss, and knows what came.
class LedgerSource {
 public:
  virtual ~LedgerSource() = default;
  /// Receives what is under way, then no more; the last frame is output with the next doProcess().
  virtual void endCapture() = 0;
  virtual PacketLedger packets() const = 0;
  virtual std::vector<std::string> lostPackets() const = 0;
  virtual std::vector<std::string> warnings() const = 0;
  /// Of the device simulator; null without one.
  virtual const PacketReplay* simulator() const = 0;
};

}  // namespace perception
