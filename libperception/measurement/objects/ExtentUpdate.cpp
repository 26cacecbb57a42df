#include "libperception/measurement/objects/ExtentUpdate.h"
#include "libperception/core/math/KalmanUpdate.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kFloor = 0.1 * 0.1;    // [m^2]
constexpr double kFloorShare = 1. / 9;  // as for nine independent errors
/// By which one is wider than the mean of its class, and a cyclist longer; assumed.
constexpr double kMostSigmas = 3;
constexpr double kLeastSigmas = 4;  // by which a vehicle is shorter; assumed

void updateSide(double seen, bool complete, double own_sigma, double sigma, double& mean,
                double& var) {
  if (!complete) {
    mean = std::max(mean, seen);
    return;
  }
  const double variance = own_sigma > 0 ? own_sigma * own_sigma : sigma * sigma;
  const double floor = own_sigma > 0 ? kFloorShare * variance : kFloor;
  ScalarEstimate side{mean, var};
  scalarUpdate({seen, variance}, side, floor);
  mean = side.mean;
  var = side.variance;
}

}  // namespace

Extent updateExtent(const Extent& extent, const PartialBox& sides, double yaw, double sigma) {
  const double angle =
      std::abs(wrapAxis(sides.yaw - yaw));  // of side a to the length axis, [0, pi/2]
  if (angle > radians(30) && angle < radians(60)) return extent;
  const bool a_is_length = angle < radians(45);
  Extent out = extent;
  updateSide(sides.length, sides.length_complete, sides.length_sigma, sigma,
             a_is_length ? out.length : out.width, a_is_length ? out.var_length : out.var_width);
  updateSide(sides.width, sides.width_complete, sides.width_sigma, sigma,
             a_is_length ? out.width : out.length, a_is_length ? out.var_width : out.var_length);
  return out;
}

Extent boundedExtent(Extent extent, const ObjectClass& c, bool told_by_shape) {
  extent.width = std::min(extent.width, c.width + kMostSigmas * c.width_sigma);
  if (told_by_shape && c.shape == ObjectShape::kCyclist)
    extent.length = std::min(extent.length, c.length + kMostSigmas * c.length_sigma);
  if (told_by_shape && c.shape == ObjectShape::kVehicle)
    extent.length = std::max(extent.length, c.length - kLeastSigmas * c.length_sigma);
  return extent;
}

}  // namespace perception
