#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/lidar/LidarDetections.h"
#include "libperception/lidar/segments/DirectionCells.h"
#include "libperception/simd/RawVector.h"

namespace perception {

/// What a cluster of returns shows in one scan; units and formulas: method.md 8.10.
enum class Feature : std::uint8_t {
  kLength,
  kWidth,
  kHeight,
  kBottom,
  kTop,
  kArea,
  kElongation,
  kUprightness,
  kSpread1,
  kSpread2,
  kSpread3,
  kLinearity,
  kPlanarity,
  kScatter,
  kNormalUp,
  kDirectionUp,
  kLength1,
  kLength2,
  kLength3,
  kLength4,
  kLength5,
  kWidth1,
  kWidth2,
  kWidth3,
  kWidth4,
  kWidth5,
  kShare1,
  kShare2,
  kShare3,
  kShare4,
  kShare5,
  kEdgeDistance,
  kEdgeShare,
  kLogReturns,
  kLogSurface,
  kSeenArea,
  kFill,
  kRows,
  kColumns,
  kRowShare,
  kRoughness,
  kHoles,
  kThrough,
  kCut,
  kIntensityMean,
  kIntensitySpread,
  kIntensityHigh,
  kRange,
  kIsolation,
  kAspect,
  kTopSpread,
  kTouching,
  kCount
};
inline constexpr auto kFeatures = static_cast<std::size_t>(Feature::kCount);
using Descriptor = std::array<float, kFeatures>;

/// Names of the features, as in model files and tables.
const std::array<const char*, kFeatures>& featureNames();

/// Describes clusters of one scan. Several threads may ask.
class ClusterDescriber {
 public:
  /// Borrows `found` and `cells`, the directions of its points.
  ClusterDescriber(const LidarDetections& found, const LidarCloud& cloud,
                   const DirectionCells& cells);

  /// `members`: indices into the obstacles, ascending; at least one.
  Descriptor describe(const std::vector<std::uint32_t>& members) const;

 private:
  /// The cluster that a thread describes.
  struct Members {
    RawVector<float> x, y, z, h;       ///< [m] offset from the sensor and height above ground
    float along_x = 1, along_y = 0;    ///< direction of the longer side
    std::vector<std::int32_t> number;  ///< of obstacles by cell: their last cluster
    std::int32_t own = 0;              ///< number of this one
    void begin(std::size_t obstacles);
  };

  void rankIntensities(const LidarCloud& cloud);
  void sortByPlace();
  static void describeEdges(Members& c, Descriptor& d);
  static void describeOutline(const Members& c, Descriptor& d);
  static void describeSpread(const Members& c, Descriptor& d);
  static void describeRoughness(const Members& c, Descriptor& d);
  void describeDirections(const Members& c, const std::vector<std::uint32_t>& members,
                          Descriptor& d) const;
  void describeIntensity(const std::vector<std::uint32_t>& members, Descriptor& d) const;
  void describeNeighbors(const Members& c, const std::vector<std::uint32_t>& members,
                         Descriptor& d) const;
  float nearestOther(const Members& c, std::uint32_t i, float within) const;

  const LidarDetections& found_;
  const DirectionCells& cells_;
  RawVector<float> dx_, dy_, dz_;  ///< [m] of the obstacles from the sensor
  RawVector<float> intensity_;     ///< rank among the scan's obstacles, [0, 1]; empty: none
  RawVector<DirectionCells::Place> place_;  ///< of the obstacles
  /// Obstacles by cell of the plane.
  RawVector<float> sorted_x_, sorted_y_;  ///< [m] from the sensor
  RawVector<std::uint32_t> rank_;         ///< of each obstacle
  std::vector<std::uint32_t> start_;      ///< first of each cell
  int columns_ = 0, rows_ = 0;
  float x0_ = 0, y0_ = 0;  ///< [m] corner of the plane's cells
};

}  // namespace perception
