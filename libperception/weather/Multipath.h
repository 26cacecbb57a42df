#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Mirror images in a wet road (method.md 9.7): [weather.multipath].
struct MultipathParams {
  bool enabled = true;
  double depth = 0.3;      ///< [m] below the ground plane (method.md 9.7)
  double tolerance = 0.4;  ///< [m] between the mirrored return and a real one (method.md 9.7)
  double max_range = 30;   ///< [m] beyond, the road may leave its plane by as much (assumed)
  double grade = 0.01;     ///< [-] growth of `depth` with range, for the same reason (assumed)
  int support = 3;         ///< real returns near the mirrored one (assumed)

  void visit(ParamVisitor& v);
};

/// Returns below the ground whose mirror image about it lies at something real: the beam went by
/// way of the road both ways. Indices into the cloud, ascending. Where trust is known, phantoms
/// count as nothing real.
std::vector<std::uint32_t> findMirrorImages(const SensorFrame& frame,
                                            const MultipathParams& params);

}  // namespace perception
