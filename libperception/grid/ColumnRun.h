#pragma once
#include <cstddef>
#include <cstdint>

#include "libperception/grid/ColumnAges.h"
#include "libperception/grid/LogOddsColumn.h"

namespace perception {

/// Columns that lie side by side in a window and in the grid's array, and what a scan says of them.
template <class Mask>
struct ColumnRun {
  std::int16_t* values;     ///< of the first one, layer by layer
  Mask *hit, *crossed;      ///< of each column, a bit a layer; zero afterwards
  std::size_t slot, count;  ///< of the first one in ColumnAges; how many
  int layers;
  unsigned turn;  ///< by which layers stand higher in the array than in the masks, around the top
  bool judged;    ///< as in LogOddsColumn::update()
};

/// Brings the columns that the scan has evidence of to its time and adds that evidence.
void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint32_t>& run,
                   ColumnAges& ages);
void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint64_t>& run,
                   ColumnAges& ages);

}  // namespace perception
