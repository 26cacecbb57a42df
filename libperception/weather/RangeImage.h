#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A scan as a picture of ranges: a pixel a direction, so that the neighbors of a return are found
/// without a search, at any range at the scale of the beams. The picture goes round; its margin
/// holds the other end's columns.
class RangeImage {
 public:
  /// Some returns of the cloud.
  struct Block {
    std::size_t first, count;
    const float* ranges;          ///< [m]; 0 where it is not finite or in the sensor itself
    const std::uint32_t* pixels;  ///< places in pixels(); 0 where there is no range
  };
  using BlockVisitor = std::function<void(const Block&)>;
  static constexpr int kColumnReach = 4, kRowReach = 2;  ///< [px] of a return's neighborhood
  static constexpr std::size_t kBlock = 960;             ///< [returns] no more in a block

  /// `column`, `row`: [rad] of a pixel (rows are even in the tangent of elevation). row = 0: found
  /// from the first scan, the finest in which neighboring beams lie in neighboring rows.
  RangeImage(double column, double row);

  /// The last return of a direction stays. `look`, where given, is shown each block of returns when
  /// they are in the nearest cache.
  void fill(const LidarCloud& cloud, const BlockVisitor& look = {});

  /// [m]; 0: no return. Rows from the lowest to the highest hold all of them, each of columns()
  /// and a margin at either end; what lies kSlack behind the last row may be read, too.
  const std::vector<float>& pixels() const { return image_; }
  static constexpr std::size_t kSlack = 8;
  std::size_t columns() const { return columns_; }
  std::size_t lowestRow() const { return lowest_; }
  std::size_t highestRow() const { return highest_; }
  std::ptrdiff_t stride() const { return stride_; }  ///< from a pixel to the row above it
  double rowPitch() const { return row_; }           ///< [rad]
  std::size_t memoryBytes() const;

 private:
  void layOut(double row);
  double findRow(const LidarCloud& cloud) const;
  double connectedShare(const LidarCloud& cloud, double row) const;
  void place(const LidarCloud& cloud, const BlockVisitor& look);
  void wipe();

  double column_, row_;
  std::size_t columns_, rows_ = 0;
  std::ptrdiff_t stride_ = 0;
  float per_radian_ = 0, rows_per_slope_ = 0;
  std::vector<float> image_;
  std::size_t lowest_ = 0, highest_ = 0;  ///< rows with returns, margins not counted
};

}  // namespace perception
