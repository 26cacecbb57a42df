#pragma once
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// Whether a track is an object or a phantom, above all one that hangs in a vehicle's wake
/// (method.md 5.19). A scan without wakes (MeasurementScan::wakes) and looks of phantoms
/// (Measurement::phantom) changes no track that was surely an object.

/// Expected phantoms per scan and area that start a track at `place` [m, world], over the expected
/// false measurements; 0 outside of wakes and for sensors that do not see spray.
double phantomDensity(const Vector2& place, const MeasurementScan& scan);
/// Odds that a cluster is a phantom and not an object, by its shape and a cause at its place.
double phantomOdds(const Measurement& m);
/// P(detected) of a track that may be either; `detection`: P_D as an object.
double detectionWithPhantom(const Track& track, const MeasurementScan& scan, double detection);
/// After the update by a measurement; `detection`: P_D as an object; `shape`: what this look adds
/// to the log odds of a phantom (rememberEvidence()).
/// `newborn`: P(phantom) of a track that would be born from the measurement.
void phantomHit(const Measurement& m, double shape, double newborn, const MeasurementScan& scan,
                double detection, const FilterModel& model, Track& track);
/// After a missed detection.
void phantomMiss(const MeasurementScan& scan, double detection, Track& track);

}  // namespace perception
