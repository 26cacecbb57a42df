#pragma once
#include <cstddef>
#include <cstdint>

#include "libperception/grid/stores/ColumnAges.h"
#include "libperception/grid/stores/LogOddsColumn.h"

namespace perception {

/// Columns that are contiguous in the window and in the grid's array, and the evidence of a scan.
template <class Mask>
struct ColumnRun {
  std::int16_t* values;     ///< of the first one, layer by layer
  Mask *hit, *crossed;      ///< of each column, a bit per layer; cleared by updateColumns()
  std::uint8_t* was_hit;    ///< of each column; set where it is hit now
  std::size_t slot, count;  ///< of the first one in ColumnAges; how many
  int layers;
  unsigned turn;  ///< cyclic shift of the layers from masks to array
  bool judged;    ///< as in LogOddsColumn::update()
};

/// Decays the columns with evidence to the time of the scan and adds the evidence.
void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint32_t>& run,
                   ColumnAges& ages);
void updateColumns(const LogOddsColumn& rules, const ColumnRun<std::uint64_t>& run,
                   ColumnAges& ages);

}  // namespace perception
