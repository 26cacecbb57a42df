#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
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

/// The same written: into bytes that are there.
inline void putLittle(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes[at + i] = static_cast<char>(value >> 8 * i);
}

inline void putBig(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t count) {
  for (std::size_t i = count; i-- > 0; value >>= 8) bytes[at + i] = static_cast<char>(value);
}

inline void putBigFloat(std::string& bytes, std::size_t at, float value) {
  std::uint32_t word = 0;
  std::memcpy(&word, &value, sizeof word);
  putBig(bytes, at, word, 4);
}

inline void putBitsMsbFirst(std::string& bytes, std::size_t first, std::size_t count,
                            std::uint32_t value) {
  for (std::size_t bit = first + count; bit-- > first; value >>= 1) {
    const int mask = 1 << (7 - bit % 8);
    const int byte = static_cast<unsigned char>(bytes[bit / 8]);
    bytes[bit / 8] = static_cast<char>((value & 1U) != 0 ? byte | mask : byte & ~mask);
  }
}

/// Two's complement of `count` bits.
inline int signedBitsMsbFirst(std::string_view bytes, std::size_t first, std::size_t count) {
  const auto value = static_cast<int>(bitsMsbFirst(bytes, first, count));
  return value >= 1 << (count - 1) ? value - (1 << count) : value;
}

}  // namespace perception
