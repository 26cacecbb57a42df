#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/scene/Scene.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {

/// The camera of a KITTI export: intrinsics and pose on the vehicle, from the log's detections or
/// images. KITTI's image boxes are in the image of camera 2, its 3D boxes in the frame of camera 0,
/// 6 cm beside it: `reference_in_camera` is the origin of camera 0 in the camera's frame.
struct KittiCamera {
  CameraModel camera;
  Pose3 T_ego_camera = Pose3::Identity();         ///< optical: x right, y down, z forward
  Vector3 reference_in_camera = Vector3::Zero();  ///< [m]; zero: 3D boxes in the camera's own frame

  /// The offset of KITTI's own recordings: K^-1 times the last column of P2, the same within 1 mm
  /// on all five days.
  static Vector3 kittiOffset() { return {0.0598, -0.0004, 0.0027}; }
};

/// One line of a KITTI tracking result file: one object in one image.
struct KittiObject {
  std::int64_t frame = 0;
  std::uint64_t id = 0;
  std::string type;  ///< Car, Pedestrian, Cyclist, Truck, Misc: kitti_type of the class
  double alpha = 0;  ///< [rad] observation angle: rotation_y minus the azimuth of the line of
                     ///< sight, in (-pi, pi]
  ObjectDetection::ImageBox box;             ///< [px] of the 3D box, clipped to the image
  double length = 0, width = 0, height = 0;  ///< [m]
  Vector3 bottom_center =
      Vector3::Zero();    ///< [m] frame of the rectified camera 0 (x right, y down, z forward)
  double rotation_y = 0;  ///< [rad] about the y axis of that frame; 0: heading along x
  double score = 0;       ///< log-odds that it exists and is a road user, within +-13.8
};

/// Selection of the exported objects.
struct KittiSelection {
  /// An object whose most probable class is not a road user (reported = false) is written as its
  /// most probable road-user class if P(exists and is a road user) is at least this.
  double road_user_from = 0.5;
  /// Smallest share of the area of an object's projected box that lies in the image. 0: any
  /// overlap. KITTI labels truncated objects up to about a half; beyond that an output counts as
  /// false there.
  double in_image = 0;
};

/// The object in KITTI's convention; empty if not selected. The box is upright along the camera's y
/// axis, as in KITTI, so that the image box equals the projection of the 3D box in the line.
std::optional<KittiObject> kittiObject(const SceneObject& object, const Scene& scene,
                                       const ClassTable& classes, const KittiCamera& camera,
                                       const KittiSelection& selection = {});

/// `frame id type 0 0 alpha x1 y1 x2 y2 h w l x y z rotation_y score`, with newline; truncated and
/// occluded are 0.
std::string kittiLine(const KittiObject& object);

/// Writes a run in KITTI's tracking format: one line per object and scene. Scenes without a frame
/// number are left out; the caller gives one scene per image frame, at the frame's stamp.
class KittiExport {
 public:
  /// Throws OutputError.
  KittiExport(const std::string& path, const ClassTable& classes, const KittiCamera& camera,
              const KittiSelection& selection = {});
  void write(const Scene& scene);
  void close();

 private:
  OutputFile file_;
  ClassTable classes_;
  KittiCamera camera_;
  KittiSelection selection_;
};

}  // namespace perception
