#pragma once
#include <cstdint>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/filter/state/FilterModel.h"
#include "libperception/filter/state/Track.h"
#include "libperception/scene/Scene.h"
#include "libperception/scene/UntoldFronts.h"

namespace perception {

/// [scene]: output of the posterior.
struct SceneParams {
  double min_existence = 0.5;  ///< objects below are not output (method.md 5.11)
  /// Class probability from which an object counts as classified [radecki2016].
  double classified_at = 0.95;
  /// KITTI export: see KittiSelection::road_user_from (assumed: even odds).
  double road_user_from = 0.5;
  /// KITTI export: see KittiSelection::in_image; 0: any overlap.
  double in_image = 0;
  /// Objects are output only if sqrt(sd_x^2 + sd_y^2) is below this share of sqrt(length * width).
  /// 0: all are. Used only with a sensor whose modality covers the sector (ModalityRow); others
  /// rarely localize objects this well.
  double place_within = 0;
  /// [m] Objects are output only if sqrt(sd_x^2 + sd_y^2) is below this (chosen, method.md 5.11):
  /// the deviation of a hidden one grows without bound. 0: all are.
  double place_sigma = 5;
  TrafficSide traffic = TrafficSide::kRight;

  void visit(ParamVisitor& v);
};

/// Reduces the most probable hypothesis to a list of objects. Stateful: assigns each track an id 1,
/// 2, 3 ... at its first output, and caches the predictions of tracks with deferred prediction.
class SceneFromPosterior {
 public:
  SceneFromPosterior(FilterModel model, SceneParams params)
      : model_(std::move(model)), params_(params) {}

  /// The objects at `ego.stamp`: predicted if that is later than the tracks, smoothed if earlier
  /// (FilterModel::history). Position and velocity are means over classes; size and heading are of
  /// the most probable class.
  Scene make(const Hypothesis& hypothesis, const EgoState& ego, std::int64_t frame);

  std::uint64_t objectsSoFar() const { return last_number_; }
  /// Forgets the ids of tracks that are not among these, which must not come again. Returns the ids
  /// that are left.
  std::set<std::uint64_t> keepOnly(const std::unordered_set<std::uint64_t>& tracks);

 private:
  /// A track with deferred prediction and its prediction at the last scene, from which the next one
  /// continues.
  struct Sleeper {
    TrackHandle track, predicted;
  };

  /// The track at that time; null if its existence is then below min_existence.
  TrackHandle trackAt(const TrackHandle& track, Stamp stamp) const;
  /// The state to predict from: the track itself, or the last scene's prediction.
  const Track& latestOf(const TrackHandle& track, Stamp stamp) const;
  void keepSleepers(const std::vector<TrackHandle>& tracks,
                    const std::vector<TrackHandle>& predicted);
  SceneObject objectOf(const Track& track);
  bool knowsPlace(const SceneObject& object) const;
  std::uint64_t numberOf(std::uint64_t track_id);

  FilterModel model_;
  SceneParams params_;
  std::unordered_map<std::uint64_t, std::uint64_t> numbers_;  ///< by track
  std::uint64_t last_number_ = 0;
  std::unordered_map<const Track*, Sleeper> sleepers_;
};

}  // namespace perception
