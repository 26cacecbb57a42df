#pragma once
#include <optional>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/models/MeasurementModel.h"

namespace perception {

/// Update by a measured heading (method.md 7): theta's axis by a scalar Kalman update, front/back
/// by the log-odds. With `may_mirror`, an axis that detections contradict repeatedly is
/// reinitialized from the measurement: the edges of an image box fit two mirrored headings, and a
/// Gaussian at the wrong one does not recover. 3D boxes have no such ambiguity.
void useHeading(const MeasuredHeading& seen, const FilterParams& params, ClassFilter& f,
                bool may_mirror = true);

/// Initializes the heading of a wheeled filter from a measured heading, the box of the measurement
/// (`birth`), or its velocity, in this order (method.md 3.4; constant-velocity instead of two-point
/// initialization). An oriented filter whose speed contradicts its front/back log-odds is reversed.
/// Whether the filter has not been oriented before and is now.
bool findHeading(const Measurement& m, const std::optional<BirthState>& birth,
                 const FilterParams& params, ClassFilter& f);

/// The size of a filter that has just found its heading: that of the class. What the edges have
/// made of a disc is the width of the side that was seen, whichever it is, and no size (method.md
/// 3.4). A front or rear that faces the sensor keeps its place.
void takeSizeOfClass(const ObjectClass& c, const SensorState& sensor, ClassFilter& f);

/// Whether the box of a lidar cluster, `birth`, repeatedly denies the axis of an oriented filter: a
/// start along a chance motion of what was seen of it, at right angles to the object. Its extent
/// and its center are then wrong, too: start anew from the box. Never when it surely moves along
/// its axis, or once has. Call once a measurement.
bool boxDeniesAxis(const Measurement& m, const std::optional<BirthState>& birth,
                   const FilterParams& params, ClassFilter& f);

/// The same as useHeading() for the body heading of an object whose state has no heading.
void updateBodyHeading(const MeasuredHeading& seen, const FilterParams& params, Track& track);
/// Whether no sensor but cameras has seen it. Ranges from images err alike from image to image, so
/// that its way is not certain.
bool isOfImagesAlone(const Track& track);
/// Front and back of the body heading by the way that its object has walked, unless seen in images
/// alone. Call once a measurement.
void faceTheWay(const FilterModel& model, Track& track);

}  // namespace perception
