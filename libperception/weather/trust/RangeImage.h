#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A scan as an image of ranges, a pixel per direction, so that neighbors of a return are found
/// without a search. The image covers the full circle; its margins repeat the columns of the other
/// end.
class RangeImage {
 public:
  /// Some returns of the cloud.
  struct Block {
    std::size_t first, count;
    const float* ranges;          ///< [m]; 0 where it is not finite or inside the sensor's housing
    const std::uint32_t* pixels;  ///< indices into pixels(); 0 without a range
  };
  using BlockVisitor = std::function<void(const Block&)>;
  static constexpr int kColumnReach = 4, kRowReach = 2;  ///< [px] of a return's neighborhood
  static constexpr std::size_t kBlock = 960;             ///< [returns] largest block

  /// `column`, `row`: [rad] pitch of the pixels (rows are uniform in the tangent of elevation). row
  /// = 0: estimated from the first scan, as the finest pitch at which neighboring beams lie in
  /// neighboring rows.
  RangeImage(double column, double row);

  /// Of several returns in a pixel the last is stored. Calls `look`, if given, for each block of
  /// returns while it is in the cache.
  void fill(const LidarCloud& cloud, const BlockVisitor& look = {});

  /// [m]; 0: no return. Rows lowestRow() to highestRow() hold all returns, in their columns
  /// firstColumn() to lastColumn(); each has columns() pixels and a margin at either end. kSlack
  /// elements behind the last row may be read, too.
  const std::vector<float>& pixels() const { return image_; }
  static constexpr std::size_t kSlack = 8;
  std::size_t columns() const { return columns_; }
  std::size_t lowestRow() const { return lowest_; }
  std::size_t highestRow() const { return highest_; }
  std::size_t firstColumn() const { return left_; }  ///< the margin not counted
  std::size_t lastColumn() const { return right_; }
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
  std::size_t left_ = 0, right_ = 0;      ///< columns with returns, margins not counted
};

}  // namespace perception
