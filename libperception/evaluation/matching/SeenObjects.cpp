#include "libperception/evaluation/matching/SeenObjects.h"

namespace perception {
namespace {

// [m] Rounding of a point of the rectangle itself.
constexpr double kOnFootprint = 1e-6;

}  // namespace

SeenTruth seenTruth(const TruthObject& object, const Pose3& T_world_ego,
                    const std::vector<std::string>& class_names,
                    const SelectionOptions& selection) {
  SeenTruth seen{&object,
                 classOfTruth(object.type, class_names),
                 makeFootprint(object.position, object.yaw, object.length, object.width),
                 {},
                 {}};
  seen.view = viewFrom(T_world_ego, seen.footprint);
  seen.use = useOf(object, seen.view, seen.class_id, selection);
  return seen;
}

std::vector<SeenEstimate> seenEstimates(const Scene& scene) {
  std::vector<SeenEstimate> seen;
  for (const SceneObject& o : scene.objects) {
    const Footprint footprint = makeFootprint(o.position, o.yaw, o.length, o.width);
    seen.push_back({&o, footprint, viewFrom(scene.ego.T_world_ego, footprint)});
  }
  return seen;
}

bool isNear(const SeenTruth& truth, const Vector2& point, double reach) {
  return (truth.footprint.center - point).norm() <= reach ||
         (closestPoint(truth.footprint, point) - point).norm() <= kOnFootprint;
}

}  // namespace perception
