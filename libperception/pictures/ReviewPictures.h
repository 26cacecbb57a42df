#pragma once
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/drawing/Renderer.h"
#include "gui-offscreen/html/ReviewPage.h"
#include "gui-offscreen/views/SceneView.h"
#include "libperception/evaluation/without_truth/Review.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Pictures of a single object for a person who is asked what it is: its outline and what the
/// sensors saw, without classes and other objects. One instance per process (see Renderer).
class ReviewPictures {
 public:
  static constexpr int kWidth = 420, kHeight = 360;  ///< [px]

  ReviewPictures();

  /// From above, forward up, 24 m across. `index`: of view.scene.objects.
  Picture fromAbove(const SceneView& view, std::size_t index);
  /// From the vehicle's roof towards the object.
  Picture fromVehicle(const SceneView& view, std::size_t index);
  /// The part of the camera's image around the object; empty if it is not in it.
  std::optional<Picture> fromCamera(const SceneView& view, std::size_t index) const;

 private:
  Picture draw(const SceneView& view, const SceneObject& object, const ViewCamera& camera);

  Renderer renderer_;
};

/// The questions about these outputs of a run, in their order, with pictures. `run_id`: for the
/// lines of answers. `sensors`: of the run's log.
std::vector<ReviewQuestion> reviewQuestions(const TrackedRun& run, const std::string& run_id,
                                            const std::vector<ReviewItem>& items,
                                            SnapshotSensors& sensors);

}  // namespace perception
