#pragma once
#include <mrpt/version.h>

#include <memory>
#include <type_traits>

// Where versions of MRPT differ: 2.5.8 (Debian 12), 2.14.7 (Debian 13). MRPT 3 will need more,
// known from its headers and notes and not tried: targets mrpt::mrpt_obs for mrpt::obs, and Eigen
// found by us; CObservation::getSensorPose() by value; mrpt::viz for the objects of mrpt::opengl;
// images without OpenCV; intensities and rings as fields of CGenericPointsMap (clouds stored as
// CPointsMapXYZI no longer load); TEntryType of CRawlog and TParticleFilterAlgorithm as enum
// classes.

namespace mrpt::maps {
class CMetricMap;
}

namespace perception {

/// What internal_CreateFromMapDefinition() of a metric map returns.
#if MRPT_VERSION >= 0x020E00
using NewMetricMap = std::shared_ptr<mrpt::maps::CMetricMap>;
#else
using NewMetricMap = mrpt::maps::CMetricMap*;
#endif

/// What a CGenericSensor has observed since the last call.
template <class Sensor>
auto observationsOf(Sensor& sensor) {
#if MRPT_VERSION >= 0x020E00
  return sensor.getObservations();
#else
  typename Sensor::TListObservations observations;
  sensor.getObservations(observations);
  return observations;
#endif
}

/// White light of a viewport: a color in MRPT 2.5, one value in 2.14.
template <class Light>
void setLight(Light& light, float value) {
  if constexpr (std::is_floating_point_v<Light>) {
    light = value;
  } else {
    light = {value, value, value, 1.0F};
  }
}

}  // namespace perception
