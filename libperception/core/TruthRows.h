#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string_view>

#include "libperception/core/Csv.h"
#include "libperception/core/GroundTruth.h"

namespace perception {

/// First line of FILE.truth.csv.
inline constexpr std::string_view kTruthHeader =
    "frame,t,id,class,x,y,z,yaw,length,width,height,vx,vy,truncated,occluded,lidar_points,ignore\n";

/// Columns of an area of the image, after those; in files that have such areas.
inline constexpr std::array<std::string_view, 4> kTruthAreaColumns = {
    "image_left", "image_top", "image_right", "image_bottom"};

/// Throws DataError for a column that is missing, even if the file has no row.
void requireTruthColumns(const CsvTable& csv);

/// One line of the truth. Throws DataError.
TruthObject readTruthRow(const CsvTable& csv, std::size_t row);

/// Checks rows in order of time: those of one instant share frame and time, an object occurs once.
class TruthOrder {
 public:
  /// Throws DataError for a row that does not fit those before.
  void add(const TruthObject& object, const CsvTable& csv, std::size_t row);

 private:
  bool begun_ = false;
  std::int64_t frame_ = -1;  // of the row before
  double t_ = 0;
  std::set<std::int64_t> frames_, ids_;
};

}  // namespace perception
