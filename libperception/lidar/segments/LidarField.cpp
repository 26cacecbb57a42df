#include "libperception/lidar/segments/LidarField.h"

#include <algorithm>
#include <cmath>

namespace perception {

LidarField::LidarField(const std::vector<std::uint8_t>& any) {
  const std::size_t columns = any.size();
  const auto least =
      static_cast<std::size_t>(std::lround(kLeastGap / kTwoPi * static_cast<double>(columns)));
  std::size_t first = 0;  // a column with returns, from which on the circle is gone around
  while (first < columns && any[first] == 0) ++first;
  if (first == columns) return;
  std::size_t gap = 0;  // columns without return up to here
  for (std::size_t k = 1; k <= columns; ++k) {
    if (k < columns && any[(first + k) % columns] == 0) {
      ++gap;
      continue;
    }
    if (gap >= least) {
      outside_.resize(columns, 0);
      for (std::size_t back = 1; back <= gap; ++back) outside_[(first + k - back) % columns] = 1;
    }
    gap = 0;
  }
}

bool LidarField::has(int column) const {
  if (outside_.empty()) return true;
  const auto columns = static_cast<int>(outside_.size());
  return outside_[static_cast<std::size_t>((column % columns + columns) % columns)] == 0;
}

bool LidarField::hasAzimuth(double azimuth) const {
  if (outside_.empty()) return true;
  return has(static_cast<int>(std::floor(azimuth / kTwoPi * static_cast<double>(outside_.size()))));
}

LidarField fieldOf(const DirectionCells& cells, const std::vector<float>& height, double ground) {
  const std::vector<std::uint8_t> any = cells.columnsWithReturns();
  LidarField field(any);
  if (field.isWhole()) return field;
  std::vector<std::uint8_t> low(any.size(), 0);
  for (std::size_t i = 0; i < height.size(); ++i)
    if (height[i] < static_cast<float>(ground))
      low[static_cast<std::size_t>(cells.placeOf(i).column)] = 1;
  const auto columns = [](const std::vector<std::uint8_t>& v) {
    return std::count(v.begin(), v.end(), 1);
  };
  return 2 * columns(low) < columns(any) ? LidarField() : field;
}

}  // namespace perception
