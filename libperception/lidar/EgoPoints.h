#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {

/// Selection of the returns of a scan: [sensor.LABEL.points].
struct PointParams {
  double range_min = 0.5;  ///< [m] horizontal; nearer returns are of the housing (assumed)
  double range_max = 80;  ///< [m] horizontal, from the sensor; clusters to about 70 m [radecki2016]
  /// [m] extent of the own vehicle ahead of the ego origin, behind it, to each side and above the
  /// ground (assumed: KITTI's car).
  double vehicle_front = 3.8, vehicle_rear = 2.0, vehicle_side = 1.3, vehicle_top = 2.2;
  bool only_objects = false;  ///< only returns that the scanner labels as object (method.md 8.1)
  int max_points = 1000000;   ///< larger scans are subsampled evenly (assumed: 5 x HDL-128)

  void visit(ParamVisitor& v);
};

/// Returns of one scan in the ego frame, in the scan's order, with their indices in the cloud.
struct EgoPoints {
  std::vector<float> x, y, z;         ///< [m] ego frame
  std::vector<std::uint32_t> source;  ///< index in the frame's cloud
  std::size_t dropped = 0;            ///< returns without a range: not finite, zero, above 1 km
  std::size_t capped = 0;            ///< returns left out because the scan has more than max_points
  Vector3 sensor = Vector3::Zero();  ///< [m] position of the sensor, ego frame
  double reach = 0;                  ///< [m] upper bound of their horizontal range from the sensor

  std::size_t size() const { return x.size(); }
};

/// The finite returns outside the own vehicle, without those that the sensor labels as rain or
/// dirt, evenly subsampled to max_points. Empty for a frame without a point cloud.
EgoPoints usablePoints(const SensorFrame& frame, const PointParams& params);

/// Tangent of the highest beam's elevation [-], from a subsample of the returns; minus infinity for
/// none.
double topSlope(const EgoPoints& points);

}  // namespace perception
