#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/FastAtan2.h"

namespace perception {

/// Which returns of a scan are used: [sensor.LABEL.points].
struct PointParams {
  double range_min = 0.5;  ///< [m] horizontal, from the sensor: nearer is the instrument (assumed)
  double range_max = 80;  ///< [m] horizontal, from the sensor; clusters to about 70 m [radecki2016]
  /// [m] own body ahead of the ego origin (assumed: below KITTI's lidar), behind it, to each side
  /// and above the ground.
  double vehicle_front = 3.8, vehicle_rear = 2.0, vehicle_side = 1.3, vehicle_top = 2.2;
  bool only_objects = false;  ///< only returns that the scanner labels as object (method.md 8.1)
  int max_points = 1000000;   ///< larger scans are thinned evenly (assumed: 5 x HDL-128)

  void visit(ParamVisitor& v);
};

/// Returns of one scan in the ego frame, in the scan's order, and where each came from.
struct EgoPoints {
  std::vector<float> x, y, z;         ///< [m] ego frame
  std::vector<std::uint32_t> source;  ///< index in the frame's cloud
  std::size_t dropped =
      0;                   ///< returns without a range: not finite, zero, beyond every instrument's
  std::size_t capped = 0;  ///< returns left out because the scan has more than max_points
  Vector3 sensor = Vector3::Zero();  ///< [m] the sensor's place, ego frame
  double reach = 0;                  ///< [m] horizontal range from the sensor that none exceeds

  std::size_t size() const { return x.size(); }
};

/// The finite returns outside the own vehicle, without those that the sensor itself calls rain or
/// dirt, evenly thinned to max_points. A frame that holds no point cloud gives none.
EgoPoints usablePoints(const SensorFrame& frame, const PointParams& params);

}  // namespace perception
