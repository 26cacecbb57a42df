#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace perception {

/// Numbers in a packet's bytes. Callers check the size first: offsets are not checked.
inline std::uint64_t littleEndian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;)
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

inline std::uint64_t bigEndian(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i)
    value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

/// IEEE 754, big endian.
inline float bigEndianFloat(std::string_view bytes, std::size_t at) {
  const auto word = static_cast<std::uint32_t>(bigEndian(bytes, at, 4));
  float value = 0;
  std::memcpy(&value, &word, sizeof value);
  return value;
}

/// `count` bits from bit `first`, counted from the most significant bit of the first byte.
inline std::uint32_t bitsMsbFirst(std::string_view bytes, std::size_t first, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t bit = first; bit < first + count; ++bit) {
    value = value << 1 | (static_cast<std::uint8_t>(bytes[bit / 8]) >> (7 - bit % 8) & 1U);
  }
  return value;
}

}  // namespace perception
