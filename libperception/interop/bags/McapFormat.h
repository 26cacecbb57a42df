#pragma once
#include <cstdint>
#include <string_view>

namespace perception::mcap {

// Of the specification, https://mcap.dev/spec.

inline constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);

enum Op : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kDataEnd = 15
};

}  // namespace perception::mcap
