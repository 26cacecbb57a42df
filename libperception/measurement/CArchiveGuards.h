#pragma once
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace perception::archive {

// Deserialization of this library's observation classes from untrusted files: counts are checked
// against a maximum, memory is allocated only as bytes arrive, and a short read throws
// (mrpt::serialization::CArchive::ReadBuffer only returns the number of bytes).

/// Largest block of memory allocated ahead of its data [bytes].
inline constexpr std::size_t kBlockBytes = 1U << 20;

inline void readExactly(mrpt::serialization::CArchive& in, void* to, std::size_t bytes) {
  if (bytes != 0 && in.ReadBuffer(to, bytes) != bytes) {
    throw std::runtime_error("the data ends inside an array");
  }
}

inline std::uint32_t readCount(mrpt::serialization::CArchive& in, std::uint32_t most,
                               const char* what) {
  const auto count = in.ReadAs<std::uint32_t>();
  if (count > most) {
    throw std::runtime_error("implausible count of " + std::string(what) + ": " +
                             std::to_string(count) + ", at most " + std::to_string(most));
  }
  return count;
}

/// A bool; throws for bytes other than 0 and 1.
inline bool readFlag(mrpt::serialization::CArchive& in) {
  const auto byte = in.ReadAs<std::uint8_t>();
  if (byte > 1) throw std::runtime_error("a bool that is neither 0 nor 1");
  return byte == 1;
}

/// An array of `count` numbers, little-endian; the count is not part of it.
template <class Number>
void readBlock(mrpt::serialization::CArchive& in, std::vector<Number>& values, std::size_t count) {
  std::array<Number, 512> piece;  // in the L1 cache, so that memory is written once
  values.clear();
  while (values.size() < count) {
    const std::size_t rest = count - values.size();
    if (values.size() == values.capacity())
      values.reserve(values.size() + std::min(rest, kBlockBytes / sizeof(Number)));
    const std::size_t part = std::min({rest, values.capacity() - values.size(), piece.size()});
    if (in.ReadBufferFixEndianness(piece.data(), part) != part * sizeof(Number)) {
      throw std::runtime_error("the data ends inside an array");
    }
    values.insert(values.end(), piece.data(), piece.data() + part);
  }
}

template <class Number>
void writeBlock(mrpt::serialization::CArchive& out, const std::vector<Number>& values) {
  if (!values.empty()) out.WriteBufferFixEndianness(values.data(), values.size());
}

/// A text as CArchive writes std::string (32-bit length, bytes), with a bound on the length.
inline std::string readText(mrpt::serialization::CArchive& in, std::uint32_t most = 4096) {
  std::string text(readCount(in, most, "characters"), '\0');
  readExactly(in, text.data(), text.size());
  return text;
}

}  // namespace perception::archive
