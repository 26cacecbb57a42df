#pragma once
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Statistical linearization of an oriented filter's prediction along its aspect (the heading as
/// seen from the sensor): which corners bound the outline of a long object, and which side a radar
/// sees, changes faster than the tangent of an EKF predicts. Given the aspect, h is nearly linear
/// in the rest of the state, so three sigma points along that direction replace the nine of a full
/// unscented transform: the mean of h, its slope (for radars that of the tangent, see AspectLine)
/// and, added to `R_model`, the residual variance of the regression (statistical linear regression:
/// Arasaratnam, Haykin and Elliott 2007; scaled sigma points: Julier 2002).
///
/// `prediction` is h at the filter's mean, with `kinematics`, on entry. Filters without heading,
/// models whose h does not depend on the aspect, and headings whose uncertainty moves the outline
/// by less than 5 cm are left unchanged.
void linearizeAlongAspect(const ObjectClass& c, const ClassFilter& filter,
                          const Kinematics& kinematics, const MeasurementModel& model,
                          const SensorState& sensor, AxisPrediction& prediction);

}  // namespace perception
