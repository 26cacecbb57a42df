#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/drawing/Picture.h"
#include "gui-offscreen/drawing/ViewCamera.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/grid/SafetyGrid.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// One lidar return.
struct ViewPoint {
  Vector3 place = Vector3::Zero();  ///< [m] world
  float height = 0;                 ///< [m] above the ground
  float trust = 1;                  ///< [0, 1] P(it is of a surface)
};

/// One radar return.
struct ViewRadarReturn {
  Vector3 place = Vector3::Zero();  ///< [m] world
  Vector2 radial_velocity{0, 0};    ///< [m/s] over ground along the line of sight, world
  bool has_rate = false;            ///< radial_velocity is valid
};

/// One measurement of a front end.
struct ViewMeasurement {
  Modality modality = Modality::kLidar;
  Vector3 place = Vector3::Zero();  ///< [m] world, approximate, on the ground
  std::vector<Vector3> outline;     ///< [m] world, visible outline; may be empty
};

/// A camera of the vehicle: its last image and detections in it.
struct ViewImage {
  struct Box {
    ObjectDetection::ImageBox box;  ///< [px]
    std::string label;
  };
  std::string sensor;  ///< label
  CameraModel camera;
  Pose3 T_world_camera = Pose3::Identity();  ///< optical, at the image's time
  double age = 0;                            ///< [s] of the image at the view's time
  Picture picture;                           ///< empty if the log has boxes but no image
  bool missing = false;                      ///< the image could not be loaded
  std::vector<Box> boxes;
};

/// Kinds of data in the log of a run; determined before the first picture, so that all pictures
/// have the same legend and size.
struct ViewLayers {
  bool lidar = false, trust = false, radar = false, measurements = false, detector_boxes = false;
  std::optional<CameraModel> camera;  ///< of the displayed image
  bool thing_ids = false;             ///< number also what is no road user
};

/// Contents of a picture of one instant. World frame.
struct SceneView {
  std::string run_name;
  double t = 0;  ///< [s] since the log's first stamp
  Scene scene;
  std::vector<std::string> class_names;  ///< by class_id
  std::map<std::uint64_t, std::vector<Vector3>>
      trails;  ///< [m] past positions by object, oldest first
  ViewLayers layers;
  std::vector<ViewPoint> points;
  std::vector<ViewRadarReturn> radar;
  std::vector<ViewMeasurement> measurements;
  std::optional<ViewImage> image;
  std::vector<GridCell> occupied;
  std::optional<Corridor> corridor;  ///< straight ahead; its free distance
  FreeDistance free;
  bool has_truth = false;
  std::vector<TruthObject> truth;

  const std::string& className(const SceneObject& object) const;
};

/// Positions of the scene's objects over the last `seconds`.
std::map<std::uint64_t, std::vector<Vector3>> trailsUpTo(const std::vector<Scene>& scenes,
                                                         std::size_t index, double seconds);

/// Below this existence probability an object is drawn with a dashed outline.
constexpr double kSureExistence = 0.9;

/// Lidar returns of lower trust are drawn as phantoms.
constexpr float kTrusted = 0.5F;

/// [m] center of the drawn vehicle ahead of the ego origin. Depends on the vehicle; this is
/// KITTI's, whose origin is below the roof lidar.
constexpr double kEgoMiddle = 0.8;

/// The eight corners of a box on the ground: bottom front left, then clockwise seen from above,
/// then the top ones alike.
std::array<Vector3, 8> boxCorners(const Vector3& bottom_center, double yaw, double length,
                                  double width, double height);

/// OpenGL objects in the ego frame: ground grid, returns, cells, boxes, the vehicle. Lines and text
/// are drawn on the picture afterwards, since MRPT renders them too thin.
std::shared_ptr<mrpt::opengl::COpenGLScene> openGlScene(const SceneView& view,
                                                        const ViewCamera& camera);

}  // namespace perception
