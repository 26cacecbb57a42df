#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// A CAN frame as our decoders take it: four bytes of identifier (big endian, without flags) and
/// the data.
std::string canMessage(std::uint32_t id, std::string_view data);
std::uint32_t canId(std::string_view message);

/// CAN frames in a datagram, as gateways to Ethernet send them (cannelloni, version 2): a number
/// that runs to 255, then the frames.
struct CanBundle {
  std::uint8_t number = 0;
  std::vector<std::string> messages;  ///< canMessage()
};
/// Throws DataError with the place.
CanBundle parseCanBundle(std::string_view datagram);
std::string canBundle(const CanBundle& bundle);

}  // namespace perception
