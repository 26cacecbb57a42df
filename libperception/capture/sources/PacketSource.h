#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/core/Time.h"

namespace perception {

/// A packet as it came.
struct ReceivedPacket {
  std::string_view bytes;    ///< valid during the call
  Stamp at;                  ///< reception, by the kernel where it tells
  std::uint64_t sender = 0;  ///< IPv4 address and port; 0: there is one only
};

/// "10.0.0.3:4711"
std::string senderName(std::uint64_t sender);

/// Where a device's packets come from.
class PacketSource {
 public:
  using Take = std::function<void(const ReceivedPacket&)>;
  virtual ~PacketSource() = default;
  /// Hands over the packets that have arrived; waits up to `timeout_ms` for the first one. False:
  /// none has arrived.
  virtual bool receive(int timeout_ms, const Take& take) = 0;
  /// Packets that the kernel had no room for.
  virtual std::uint64_t overrun() const { return 0; }
  /// What happened since the last call, for the user.
  virtual std::vector<std::string> takeEvents() { return {}; }
};

/// Datagrams to a port of `address` of this computer, of its multicast group (may be empty), too.
/// Throws Error (kUnavailable); `name`: of the sensor, for messages.
std::unique_ptr<PacketSource> openUdp(const std::string& name, const std::string& address,
                                      std::uint16_t port, const std::string& multicast);

/// Ibeo's messages from a TCP server. If the server is not there, or goes away, this tries again
/// every half second. Throws ConfigError if `host` is not an IPv4 address.
std::unique_ptr<PacketSource> openIbeoTcp(const std::string& name, const std::string& host,
                                          std::uint16_t port);

/// Frames of a CAN bus by SocketCAN, classic and FD, as canMessage(). Throws Error (kUnavailable):
/// the kernel has no CAN, or no such interface.
std::unique_ptr<PacketSource> openCan(const std::string& name, const std::string& interface);

}  // namespace perception
