#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// [sensor.LABEL.geometry]: how well an image box says where its object stands
/// (method.md 4.2).
struct BoxGeometryParams {
  double edge_sigma = 3;  ///< [px] of the left and right edge; assumed ...
  /// ... and of the box's width: sd .05 to .17 on KITTI (RRC), but the boxes of one object err
  /// alike for seconds, and a filter that takes them for independent must doubt them more. Tuned on
  /// KITTI.
  double edge_share = 0.4;
  double bottom_sigma = 4;  ///< [px] of the lower edge; assumed
  /// Of the box's height, added to it: detectors of people stop above a cycle's wheels; tuned on
  /// KITTI.
  double bottom_share = 0.05;
  /// [rad] of the line of sight against the ground, beside the pose's own; assumed.
  double pitch_sigma = radians(0.5);
  double range_floor = 0.2;  ///< [m] added to the range's deviation; assumed
  double border = 10;        ///< [px] an edge this near to the image's border is cut off; assumed
  /// Where feet are out of the picture, detectors end the box above its border: a lower edge within
  /// this share of the height of an upright box (higher than wide) of it may be such a one; tuned
  /// on KITTI ...
  double border_share = 0.2;
  /// ... and its range is doubted by this share more. KITTI (RRC): people within 5 m stand .57 of
  /// their range too far, cars do not.
  double cut_share = 0.4;
  double max_range = 60;  ///< [m] beyond it the ground says nothing; assumed

  void visit(ParamVisitor& v);
};

/// What an image box says of an object that stands on the ground, seen from the camera in a level
/// frame (x forward).
struct BoxOnGround {
  double left = 0, right = 0;  ///< [rad] bearings of its edges, counter-clockwise off forward
  bool left_seen = false, right_seen = false;  ///< false: cut off by the image's border
  double left_sigma = 0, right_sigma = 0;      ///< [rad]
  std::optional<double> range;  ///< [m] on the ground, to the object's nearest point; empty: cut
                                ///< off, above the horizon
  double range_sigma = 0;       ///< [m]
  double height = 0, height_sigma = 0;  ///< [m] of the object, with a range only
  double base = 0, base_sigma = 0;      ///< [m] its lower end, ego frame, with a range only
};

/// [rad, ccw, in (-pi, pi]] middle of a box between the bearings of its edges, also across the
/// rear.
inline double middleBearing(double left, double right) {
  return wrapAngle(right + 0.5 * wrapAngle(left - right));
}

/// The two halves of objects that a panorama's seam cuts, put together: boxes of one label of which
/// one ends at the right border, the other begins at the left one, at about the same rows. The
/// joined box reaches beyond the image's width, has the better score and stands at the place of its
/// left half in the list; `border` [px]. Other images are left as they are. Returns for each object
/// the index that it had.
std::vector<std::size_t> joinSeam(const CameraModel& camera, double border,
                                  std::vector<ObjectDetection>& objects);

/// The level frame of a camera: x forward along its optical axis, z up, at its optical center, in
/// the ego frame.
Pose3 levelFrame(const Pose3& T_ego_camera);

/// `T_ego_camera` is optical (x right, y down, z forward). The ground holds in the ego frame, so
/// the camera's pitch and roll against it are part of the geometry. In a panorama that closes, a
/// box over the seam reaches beyond the image's width (or begins left of 0): its columns are
/// angles. Empty when the box is none or lies behind the camera's horizon. `height_prior` [m] of
/// what the label names tells the range, too, by the angle that the box is high, unless the ground
/// contradicts it (a van among cars): it holds where pitch and slope make the ground's wrong.
std::optional<BoxOnGround> boxOnGround(const ObjectDetection::ImageBox& box,
                                       const CameraModel& camera, const Pose3& T_ego_camera,
                                       const GroundPlane& ground,
                                       const PoseUncertainty& uncertainty,
                                       const BoxGeometryParams& params,
                                       const std::optional<ScalarEstimate>& height_prior = {});

}  // namespace perception
