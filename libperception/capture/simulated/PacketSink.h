#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

namespace perception {

/// Where a device simulator's packets go. They never leave this computer.
class PacketSink {
 public:
  virtual ~PacketSink() = default;
  /// Waits until there is a receiver or `stop` is set. False: there is no receiver.
  virtual bool ready(const std::atomic<bool>& stop) = 0;
  /// Whether it was sent whole.
  virtual bool send(const std::string& payload) = 0;
};

/// Datagrams to a port of the loopback interface.
std::unique_ptr<PacketSink> loopbackUdp(std::uint16_t port);
/// A server of one client on the loopback interface. Throws Error (kUnavailable).
std::unique_ptr<PacketSink> loopbackTcp(std::uint16_t port);
/// Frames to a CAN interface, which should be a virtual one. Throws Error (kUnavailable).
std::unique_ptr<PacketSink> canSink(const std::string& interface);

}  // namespace perception
