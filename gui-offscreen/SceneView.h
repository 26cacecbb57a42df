#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/Picture.h"
#include "gui-offscreen/ViewCamera.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/grid/SafetyGrid.h"
#include "libperception/scene/Scene.h"

namespace mrpt::opengl {
class COpenGLScene;
}

namespace perception {

/// One lidar return as it is drawn.
struct ViewPoint {
  Vector3 place = Vector3::Zero();  ///< [m] world
  float height = 0;                 ///< [m] above the ground
  float trust = 1;                  ///< [0, 1] P(it is of a surface)
};

/// One radar return as it is drawn.
struct ViewRadarReturn {
  Vector3 place = Vector3::Zero();  ///< [m] world
  Vector2 radial_velocity{0, 0};    ///< [m/s] over ground along the line of sight, world
  bool has_rate = false;            ///< the line above is known
};

/// What a front end took for one object, before any tracking.
struct ViewMeasurement {
  Modality modality = Modality::kLidar;
  Vector3 place = Vector3::Zero();  ///< [m] world, on the ground; rough
  std::vector<Vector3> outline;     ///< [m] world, about what was seen; may be empty
};

/// A camera of the vehicle: its last image and what a detector found in it.
struct ViewImage {
  struct Box {
    ObjectDetection::ImageBox box;  ///< [px]
    std::string label;
  };
  std::string sensor;  ///< label
  CameraModel camera;
  Pose3 T_world_camera = Pose3::Identity();  ///< optical, at the image's time
  double age = 0;                            ///< [s] of the image at the view's time
  Picture picture;                           ///< empty: the log has boxes, but no image
  bool missing = false;  ///< there should be an image, but it could not be loaded
  std::vector<Box> boxes;
};

/// What the log of a run holds. Known before the first picture, so that all pictures of a log have
/// the same legend and size.
struct ViewLayers {
  bool lidar = false, trust = false, radar = false, measurements = false, detector_boxes = false;
  std::optional<CameraModel> camera;  ///< of the image that is shown
};

/// All that a picture of one instant shows. World frame.
struct SceneView {
  std::string run_name;
  double t = 0;  ///< [s] since the log's first stamp
  Scene scene;
  std::vector<std::string> class_names;  ///< by class_id
  std::map<std::uint64_t, std::vector<Vector3>>
      trails;  ///< [m] past places by object, oldest first
  ViewLayers layers;
  std::vector<ViewPoint> points;
  std::vector<ViewRadarReturn> radar;
  std::vector<ViewMeasurement> measurements;
  std::optional<ViewImage> image;
  std::vector<GridCell> occupied;
  std::optional<Corridor> corridor;  ///< straight ahead, with what is free of it
  FreeDistance free;
  bool has_truth = false;
  std::vector<TruthObject> truth;

  const std::string& className(const SceneObject& object) const;
};

/// Places of the scene's objects over the last `seconds`, from the scenes before it.
std::map<std::uint64_t, std::vector<Vector3>> trailsUpTo(const std::vector<Scene>& scenes,
                                                         std::size_t index, double seconds);

/// Below this existence probability an object is drawn with a dashed outline.
constexpr double kSureExistence = 0.9;

/// Below this trust a lidar return counts as one of the weather.
constexpr float kTrusted = 0.5F;

/// [m] ahead of the ego origin to the middle of the drawn vehicle. Where the origin lies in the
/// body depends on the vehicle; this is a car whose lidar stands on the roof (KITTI's).
constexpr double kEgoMiddle = 0.8;

/// The eight corners of a box on the ground: bottom front left, then clockwise seen from above,
/// then the top ones alike.
std::array<Vector3, 8> boxCorners(const Vector3& bottom_center, double yaw, double length,
                                  double width, double height);

/// The solid things as OpenGL objects in the ego frame: ground grid, returns, cells, boxes, the
/// vehicle. Lines and text are drawn on the picture afterwards, since MRPT draws both thinly.
std::shared_ptr<mrpt::opengl::COpenGLScene> openGlScene(const SceneView& view,
                                                        const ViewCamera& camera);

}  // namespace perception
