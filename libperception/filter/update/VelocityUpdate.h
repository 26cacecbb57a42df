#pragma once
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/measurement/Measurement.h"

namespace perception {

/// Whether that kind of sensor has detected the object so rarely that its positions do not tell its
/// velocity well. Later they do, and the same scans would count twice.
inline bool isYoung(const Track& track, Modality modality) {
  constexpr int kYoung = 4;  // detections (assumed)
  return track.hits[modalityIndex(modality)] <= kYoung;
}

/// Kalman update of the velocity of a filter of a class that moves by a measured component of it
/// (method.md 4.3, 8.16); modes become likelier as they fit.
void updateVelocity(const RadialSpeed& seen, ClassFilter& f);

/// log p(radial speed | class, its filter before) [log s/m]: with a small probability it is that of
/// something else.
double logRadialSpeed(const ObjectClass& c, const ClassFilter& f, const RadialSpeed& seen);

/// Whether an oriented filter cannot move so along its heading, whatever its speed: the heading is
/// that of a box that a cloud has stretched.
bool deniesHeading(const RadialSpeed& seen, const ClassFilter& f);

/// Log likelihood of the speed: constant up to the class's max_speed, then a Gaussian tail.
double logSpeed(const ObjectClass& c, const ClassFilter& f, const FilterParams& params);

}  // namespace perception
