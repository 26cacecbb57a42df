#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace perception {

/// Elements that pack() may write behind the packed ones.
constexpr std::size_t kPackSlack = 16;

/// A column of 32-bit numbers and the destination of its marked rows; `to` may equal `from` or
/// precede it.
struct Column {
  const void* from;
  void* to;
};

/// Stream compaction without branches: moves the marked (non-zero) ones of `count` rows to the
/// front, in their order. Returns how many they are.
template <std::size_t kColumns>
std::size_t pack(const std::int32_t* marks, std::size_t count,
                 const std::array<Column, kColumns>& columns);

/// Writes the indices of the marked rows, counted from `first`. Returns how many they are.
std::size_t packPlaces(const std::int32_t* marks, std::size_t count, std::uint32_t first,
                       std::uint32_t* places);

}  // namespace perception
