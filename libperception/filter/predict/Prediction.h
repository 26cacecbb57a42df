#pragma once
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Pass 1: the track at a later time: every class filter, existence, class chain, base height
/// (method.md 5.1, 5.7).
Track predictTrack(const Track& track, Stamp to, const FilterModel& model);

/// Existence and class probabilities of a track predicted to a later time.
struct TrackOdds {
  double existence = 0;
  std::vector<double> log_class;
};
/// The existence alone.
double predictExistence(const Track& track, Stamp to, const FilterModel& model);
TrackOdds predictOdds(const Track& track, Stamp to, const FilterModel& model);

/// [s] in which the existence falls below existence_min without detections.
double timeToLive(const Track& track, const FilterModel& model);

/// predictTrack() for those tracks that are `touched`, their Gaussians in batches (see BankBatch);
/// the others stay empty. Equal up to rounding.
std::vector<Track> predictTracks(const std::vector<TrackHandle>& tracks,
                                 const std::vector<char>& touched, Stamp to,
                                 const FilterModel& model);

}  // namespace perception
