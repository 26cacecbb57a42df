#pragma once
#include <vector>

#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"

namespace perception {

/// Pass 1: predicts the track to a later time: class filters, existence, class chain, base height
/// (method.md 5.1, 5.7).
Track predictTrack(const Track& track, Stamp to, const FilterModel& model);

/// Predicted existence probability and log class probabilities of a track.
struct TrackOdds {
  double existence = 0;
  std::vector<double> log_class;
};
/// The existence probability alone.
double predictExistence(const Track& track, Stamp to, const FilterModel& model);
TrackOdds predictOdds(const Track& track, Stamp to, const FilterModel& model);

/// [s] until the existence probability falls below `existence_min` without detections.
double timeToLive(const Track& track, const FilterModel& model);

/// [s] after which no track is left without detections: timeToLive() of a track just seen.
double longestLife(const FilterParams& params);

/// predictTrack() of all `touched` tracks, their Gaussians in batches (see BankBatch); equal up to
/// rounding. Other entries stay empty.
std::vector<Track> predictTracks(const std::vector<TrackHandle>& tracks,
                                 const std::vector<char>& touched, Stamp to,
                                 const FilterModel& model);

}  // namespace perception
