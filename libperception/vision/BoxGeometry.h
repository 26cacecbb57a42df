#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/Measurement.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [sensor.LABEL.geometry]: noise of the geometry of image boxes (method.md 4.2).
struct BoxGeometryParams {
  double edge_sigma = 3;  ///< [px] of the left and right edge; assumed
  /// Share of the box's width, added to edge_sigma: deviations are .05 to .17 on KITTI (RRC), but
  /// errors of the boxes of one object are correlated over seconds, which a filter that assumes
  /// independence needs inflated. Tuned on KITTI.
  double edge_share = 0.4;
  double bottom_sigma = 4;  ///< [px] of the lower edge; assumed
  /// Share of the box's height, added to bottom_sigma: detectors of people stop above a cycle's
  /// wheels; tuned on KITTI.
  double bottom_share = 0.05;
  /// [rad] of the line of sight relative to the ground, besides that of the pose; assumed.
  double pitch_sigma = radians(0.5);
  double range_floor = 0.2;  ///< [m] added to the deviation of the range; assumed
  double border = 10;        ///< [px] an edge this close to the image's border is cut off; assumed
  /// When feet are outside the image, detectors end the box above its border. The lower edge of an
  /// upright box (higher than wide) within this share of its height of the border may be of that
  /// kind; tuned on KITTI.
  double border_share = 0.2;
  /// Share of its range that is added to the deviation then. KITTI (RRC): ranges of people within 5
  /// m are too large by .57, those of cars are not.
  double cut_share = 0.4;
  double max_range = 60;  ///< [m] beyond it the ground gives no range; assumed

  void visit(ParamVisitor& v);
};

/// Geometry of an object on the ground by its image box, in the camera's level frame (x forward).
struct BoxOnGround {
  double left = 0, right = 0;  ///< [rad] bearings of its edges, counter-clockwise off forward
  bool left_seen = false, right_seen = false;  ///< false: cut off by the image's border, or hidden
  double left_sigma = 0, right_sigma = 0;      ///< [rad]
  std::optional<double> range;  ///< [m] on the ground, to the object's nearest point; empty when
                                ///< the lower edge is cut off or above the horizon
  double range_sigma = 0;       ///< [m]
  double height = 0, height_sigma = 0;  ///< [m] of the object; only with a range
  double base = 0, base_sigma = 0;      ///< [m] its lower end, ego frame; only with a range
};

/// Joins the halves of objects that are cut by a panorama's seam: boxes of one label of which one
/// ends at the right border and the other begins at the left one, in about the same rows. The
/// joined box extends beyond the image's width, has the better score and the list position of the
/// half at the right border; `border` [px]. Other images are unchanged. Returns for each object its
/// former index.
std::vector<std::size_t> joinSeam(const CameraModel& camera, double border,
                                  std::vector<ObjectDetection>& objects);

/// Edges of an image box at which a nearer object hides the rest.
struct HiddenEdges {
  bool left = false, right = false;
};

/// The edges of `box` that lie in one of `others`, up to `tolerance` [px], which covers at least
/// half of its rows and ends lower in the image: it stands nearer on the ground (method.md 4.2).
HiddenEdges hiddenEdges(const ObjectDetection::ImageBox& box,
                        const std::vector<ObjectDetection::ImageBox>& others, double tolerance);

/// The level frame of a camera (T_ego_level): x along the optical axis, z up, origin at the optical
/// center.
Pose3 levelFrame(const Pose3& T_ego_camera);

/// `T_ego_camera` is optical (x right, y down, z forward). The ground plane is in the ego frame, so
/// the camera's pitch and roll relative to it are included. In a full panorama a box across the
/// seam extends beyond the image's width (or begins left of 0): its columns are angles. Empty when
/// the box or the camera is invalid. `height_prior` [m] of the label gives a second range by the
/// angular height of the box (method.md (15)), independent of pitch and slope; it is ignored where
/// it contradicts the ground range (a van among cars).
std::optional<BoxOnGround> boxOnGround(const ObjectDetection::ImageBox& box,
                                       const CameraModel& camera, const Pose3& T_ego_camera,
                                       const GroundPlane& ground,
                                       const PoseUncertainty& uncertainty,
                                       const BoxGeometryParams& params,
                                       const std::optional<ScalarEstimate>& height_prior = {});

}  // namespace perception
