#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace perception {

/// Written beyond what is packed, at most.
constexpr std::size_t kPackSlack = 16;

/// A column of 32-bit numbers and where its marked rows go; `to` may be `from` or lie before it.
struct Column {
  const void* from;
  void* to;
};

/// Moves the marked ones of `count` rows to the front, in their order, without a branch: their
/// number. Marks are 0 or not.
template <std::size_t kColumns>
std::size_t pack(const std::int32_t* marks, std::size_t count,
                 const std::array<Column, kColumns>& columns);

/// The numbers of the marked rows, the first of which is `first`: how many there are.
std::size_t packPlaces(const std::int32_t* marks, std::size_t count, std::uint32_t first,
                       std::uint32_t* places);

}  // namespace perception
