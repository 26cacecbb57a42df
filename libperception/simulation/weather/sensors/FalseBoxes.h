#pragma once
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// False boxes of an image detector in rain: drops on the lens and mirror images in the wet road.
/// With `wetness` 1 a detector of the precision that [radecki2016] reports on sunny days (cars .95,
/// people .90) comes down to that of rainy ones (.93, .76): method.md 9.9. Frames without image
/// boxes are not changed.
void addFalseBoxes(double wetness, SensorFrame& frame, Rng& rng);

}  // namespace perception
