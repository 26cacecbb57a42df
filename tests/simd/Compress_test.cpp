#include "libperception/simd/Compress.h"

#include <gtest/gtest.h>

#include <vector>

#include "libperception/core/math/Random.h"

namespace perception {
namespace {

struct Rows {
  std::vector<std::int32_t> marks;
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint32_t> marked, places;  // as they ought to come out
};

Rows rowsOf(std::size_t count, double share) {
  Rows rows;
  Rng random({count, 0, 0, 0});
  for (std::size_t i = 0; i < count; ++i) {
    const bool mark = random.uniform(0, 1) < share;
    rows.marks.push_back(mark ? static_cast<std::int32_t>(1 + i) : 0);
    rows.numbers.push_back(static_cast<std::uint32_t>(7 * i + 3));
    if (!mark) continue;
    rows.marked.push_back(rows.numbers.back());
    rows.places.push_back(static_cast<std::uint32_t>(i + 100));
  }
  return rows;
}

TEST(Pack, KeepsMarkedRowsInTheirOrderForEveryNumberOfThem) {
  for (const double share : {0.0, 0.3, 1.0})
    for (std::size_t count = 0; count < 70; ++count) {
      const Rows rows = rowsOf(count, share);
      std::vector<std::vector<std::uint32_t>> to(6,
                                                 std::vector<std::uint32_t>(count + kPackSlack, 0));
      std::array<Column, 6> columns;
      for (std::size_t c = 0; c < 6; ++c) columns[c] = {rows.numbers.data(), to[c].data()};
      const std::size_t kept = pack(rows.marks.data(), count, columns);
      ASSERT_EQ(kept, rows.marked.size());
      for (auto& column : to) {
        column.resize(kept);
        EXPECT_EQ(column, rows.marked) << count << " rows, " << share;
      }
    }
}

TEST(Pack, MovesRowsWithinTheirOwnColumn) {
  Rows rows = rowsOf(1000, 0.4);
  std::array<Column, 6> columns;
  std::vector<std::vector<std::uint32_t>> own(6, rows.numbers);
  for (std::size_t c = 0; c < 6; ++c) columns[c] = {own[c].data(), own[c].data()};
  const std::size_t kept = pack(rows.marks.data(), rows.marks.size(), columns);
  for (auto& column : own) {
    column.resize(kept);
    EXPECT_EQ(column, rows.marked);
  }
}

TEST(Pack, TellsPlacesOfMarkedRows) {
  for (std::size_t count = 0; count < 70; ++count) {
    const Rows rows = rowsOf(count, 0.5);
    std::vector<std::uint32_t> places(count + kPackSlack);
    places.resize(packPlaces(rows.marks.data(), count, 100, places.data()));
    EXPECT_EQ(places, rows.places);
  }
}

}  // namespace
}  // namespace perception
