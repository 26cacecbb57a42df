#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// A CAN frame as our decoders take it: four bytes of identifier (big endian, without flags) and
/// the data.
std::string canMessage(std::uint32_t id, std::string_view data);
std::uint32_t canId(std::string_view message);

/// A line of `candump -l`: "(1436509052.249713) can0 123#1122AABB", of CAN FD "123##1AABB".
struct CandumpLine {
  std::int64_t stamp_ns = 0;
  std::string interface;
  std::string message;  ///< canMessage()
};
/// Empty for an empty line, a comment, a remote or an error frame: they have no data. Throws
/// DataError for what is none of these.
std::optional<CandumpLine> parseCandump(std::string_view line);

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
