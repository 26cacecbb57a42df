#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "libperception/measurement/ObjectClass.h"
#include "libperception/scene/OutputFile.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// The camera in whose images KITTI's lines are given: its model and its optical pose on the
/// vehicle, as the log's detections or images carry them. KITTI's image camera is number 2, while
/// its boxes stand in the frame of camera 0, 6 cm beside it: `reference_in_camera` is the place of
/// camera 0 in the camera's frame.
struct KittiCamera {
  CameraModel camera;
  Pose3 T_ego_camera = Pose3::Identity();  ///< optical: x right, y down, z forward
  Vector3 reference_in_camera =
      Vector3::Zero();  ///< [m]; zero: the boxes are given in the camera's own frame

  /// The offset of KITTI's own recordings: K^-1 times the last column of P2, the same within 1 mm
  /// on all five days.
  static Vector3 kittiOffset() { return {0.0598, -0.0004, 0.0027}; }
};

/// One line of a KITTI tracking result: one object in one image.
struct KittiObject {
  std::int64_t frame = 0;
  std::uint64_t id = 0;
  std::string type;  ///< Car, Pedestrian, Cyclist, Truck, Misc: kitti_type of the class
  double alpha = 0;  ///< [rad] rotation_y minus the direction of sight, in (-pi, pi]
  ObjectDetection::ImageBox box;             ///< [px] of the 3D box, clipped to the image
  double length = 0, width = 0, height = 0;  ///< [m]
  Vector3 bottom_center =
      Vector3::Zero();    ///< [m] frame of the rectified camera 0 (x right, y down, z forward)
  double rotation_y = 0;  ///< [rad] about that frame's y axis; 0: the front looks along x
  double score = 0;       ///< log-odds that it exists and is no mere thing, within +-13.8
};

/// What of the objects becomes a line.
struct KittiSelection {
  /// An object that may be a mere thing is written as the road user that it may be when it exists
  /// and is one with at least this probability.
  double road_user_from = 0.5;
  /// Share of its box's area, as the camera would see it without borders, that lies in the image:
  /// objects with less are not written. 0: all that touch the image. KITTI labels what leaves the
  /// image up to about a half; what is written beyond that counts as false there.
  double in_image = 0;
};

/// The object as KITTI sees it; empty when the selection leaves it out. The box stands upright
/// along the camera's y axis, as in KITTI, so that the image box is the one that a reader of the
/// line computes.
std::optional<KittiObject> kittiObject(const SceneObject& object, const Scene& scene,
                                       const ClassTable& classes, const KittiCamera& camera,
                                       const KittiSelection& selection = {});

/// `frame id type 0 0 alpha x1 y1 x2 y2 h w l x y z rotation_y score`, with line feed; truncated
/// and occluded are 0.
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
