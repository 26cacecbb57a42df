#pragma once
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/matching/Footprint.h"
#include "libperception/evaluation/matching/TruthSelection.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// A truth object as the vehicle sees it at a scene.
struct SeenTruth {
  const TruthObject* object = nullptr;  ///< must outlive this
  ClassId class_id = -1;                ///< in the run's class names; -1: no class covers its type
  Footprint footprint;                  ///< world
  GroundView view;                      ///< from the ego frame's origin
  TruthUse use = TruthUse::kCounts;
};
/// `T_world_ego` and `class_names` are those of the scene and its run.
SeenTruth seenTruth(const TruthObject& object, const Pose3& T_world_ego,
                    const std::vector<std::string>& class_names, const SelectionOptions& selection);

/// The same for an object of the scene.
struct SeenEstimate {
  const SceneObject* object = nullptr;  ///< must outlive this
  Footprint footprint;                  ///< world
  GroundView view;                      ///< from the ego frame's origin
};
/// All objects of a scene, in its order.
std::vector<SeenEstimate> seenEstimates(const Scene& scene);

/// Centers on the ground [m], world. Seen: SeenTruth or SeenEstimate.
template <class Seen>
std::vector<Vector2> centers(const std::vector<Seen>& seen) {
  std::vector<Vector2> result;
  for (const Seen& s : seen) result.push_back(s.footprint.center);
  return result;
}

/// Whether `point` [m], world, is within `reach` [m] of the truth object's center or on its
/// footprint (a tram is longer than that).
bool isNear(const SeenTruth& truth, const Vector2& point, double reach);

}  // namespace perception
