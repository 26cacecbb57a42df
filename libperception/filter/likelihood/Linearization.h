#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/MeasurementModel.h"

namespace perception {

/// Statistical linearization of an oriented filter's prediction along its aspect (the heading as
/// seen from the sensor): the outline of a long object changes corners, and the side that a radar
/// sees, faster than one tangent tells. Given the aspect all else is nearly linear, so three sigma
/// points along that one direction of the state do for the nine of a whole one: the mean of h, its
/// slope (radars keep the tangent's, see AspectLine) and, in `R_model`, what the line leaves
/// unexplained (statistical linear regression: Arasaratnam, Haykin and Elliott 2007; scaled sigma
/// points: Julier 2002).
///
/// `prediction` is h at the filter's mean, with `kinematics`, on entry. Filters without heading,
/// models that do not see the aspect, and headings known to within 5 cm of the outline stay as they
/// are.
void linearizeAlongAspect(const ObjectClass& c, const ClassFilter& filter,
                          const Kinematics& kinematics, const MeasurementModel& model,
                          const SensorState& sensor, AxisPrediction& prediction);

}  // namespace perception
