#pragma once
#include <type_traits>

// Where versions of MRPT differ: 2.5.8 (Debian 12), 2.14.7 (Debian 13). Told apart by types, so
// that no code here includes MRPT or asks for a version. MRPT 3 will need more, known from its
// headers and notes and not tried: targets mrpt::mrpt_obs for mrpt::obs, and Eigen found by us;
// CObservation::getSensorPose() by value; mrpt::viz for the objects of mrpt::opengl; images without
// OpenCV; intensities and rings as fields of CGenericPointsMap (clouds stored as CPointsMapXYZI no
// longer load); TEntryType of CRawlog and TParticleFilterAlgorithm as enum classes.

namespace perception {
namespace mrpt_versions {

template <class Sensor, class List>
auto take(Sensor& sensor, List& list, int) -> decltype(sensor.getObservations(list), void()) {
  sensor.getObservations(list);  // 2.5
}
template <class Sensor, class List>
void take(Sensor& sensor, List& list, long) {
  list = sensor.getObservations();  // 2.14
}

}  // namespace mrpt_versions

/// What a CGenericSensor has observed since the last call.
template <class Sensor>
auto observationsOf(Sensor& sensor) {
  typename Sensor::TListObservations observations;
  mrpt_versions::take(sensor, observations, 0);
  return observations;
}

/// White light of a viewport: a color in 2.5, one value in 2.14.
template <class Light>
void setLight(Light& light, float value) {
  if constexpr (std::is_floating_point_v<Light>) {
    light = value;
  } else {
    light = {value, value, value, 1.0F};
  }
}

/// What a function returns: internal_CreateFromMapDefinition() gives a pointer in 2.5, a shared
/// pointer in 2.14.
template <class Result, class Argument>
Result resultOf(Result (*)(Argument));

}  // namespace perception
