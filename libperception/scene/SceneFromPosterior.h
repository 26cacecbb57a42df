#pragma once
#include <unordered_map>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// [scene]: what of the posterior becomes the output.
struct SceneParams {
  double min_existence = 0.5;  ///< objects below are not output (method.md 5.11)
  /// Class probability from which an object counts as classified [radecki2016].
  double classified_at = 0.95;
  /// KITTI export: an object that may be a mere thing is written as the road user that it may be
  /// from this probability on (assumed: even odds).
  double road_user_from = 0.5;
  /// KITTI export: share of its image box that an object must have in the image; 0: any.
  double in_image = 0;
  /// Share of sqrt(length * width) to which a place must be known (deviations of x and y together):
  /// objects less certain are tracked, but not output. 0: all are. Only where a sensor takes part
  /// that covers the sector (ModalityRow): others know few places so well.
  double place_within = 0;

  void visit(ParamVisitor& v);
};

/// Reduces the most probable hypothesis to a list of objects. Gives every track a small number at
/// its first output, and keeps it; that, and how far tracks out of view were predicted, is its
/// state.
class SceneFromPosterior {
 public:
  SceneFromPosterior(FilterModel model, SceneParams params)
      : model_(std::move(model)), params_(params) {}

  /// The objects at `ego.stamp`: a prediction of a copy when that is later than the tracks,
  /// smoothed when it is earlier (FilterModel::history). The mean over classes of position and
  /// velocity, size and heading of the most probable class.
  Scene make(const Hypothesis& hypothesis, const EgoState& ego, std::int64_t frame);

  std::uint64_t objectsSoFar() const { return numbers_.size(); }

 private:
  /// A track that the filter left behind, and what the last scene made of it: the next goes on from
  /// there.
  struct Sleeper {
    TrackHandle track, predicted;
  };

  /// The track at that time; null when it is not believed in, then.
  TrackHandle trackAt(const TrackHandle& track, Stamp stamp) const;
  /// What to predict it from: itself, or the last scene's prediction.
  const Track& latestOf(const TrackHandle& track, Stamp stamp) const;
  void keepSleepers(const Hypothesis& hypothesis, const std::vector<TrackHandle>& predicted);
  SceneObject objectOf(const Track& track);
  bool knowsPlace(const SceneObject& object) const;
  std::uint64_t numberOf(std::uint64_t track_id);

  FilterModel model_;
  SceneParams params_;
  std::unordered_map<std::uint64_t, std::uint64_t> numbers_;
  std::unordered_map<const Track*, Sleeper> sleepers_;
};

}  // namespace perception
