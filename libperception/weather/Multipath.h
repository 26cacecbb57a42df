#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Mirror images in a wet road (method.md 9.7): [weather.multipath].
struct MultipathParams {
  bool enabled = true;
  double depth = 0.3;      ///< [m] below the ground plane (method.md 9.7)
  double tolerance = 0.4;  ///< [m] between the mirrored return and a real one (method.md 9.7)
  double max_range = 30;   ///< [m] beyond it, the road deviates from its plane (assumed)
  double grade = 0.01;     ///< [-] growth of `depth` with range, for the same reason (assumed)
  int support = 3;         ///< least number of trusted returns near the image (assumed)

  void visit(ParamVisitor& v);
};

/// Returns below the ground plane whose mirror image about it lies among real returns: both paths
/// of the pulse were reflected by the road. Indices into the cloud, ascending. Returns of low trust
/// do not count as real.
std::vector<std::uint32_t> findMirrorImages(const SensorFrame& frame,
                                            const MultipathParams& params);

}  // namespace perception
