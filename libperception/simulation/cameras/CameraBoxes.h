#pragma once
#include <functional>
#include <optional>

#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

class LidarCaster;
class World;

/// A camera with an image detector: [sensor.LABEL] kind = camera_boxes. Defaults: a recent detector
/// on KITTI's camera [geiger2012], rates assumed; recall and headings are better than those of the
/// part models in [radecki2016].
struct CameraParams {
  int width = 1242, height = 375;  ///< [px] KITTI
  double fov = radians(81);        ///< [rad] horizontal; KITTI: f = 721 px
  double recall = 0.9;             ///< of an unoccluded object of full_pixels or more
  double min_pixels = 20,
         full_pixels = 40;   ///< [px] box height below which recall is 0, above which it is full
  double edge_noise = 0.03;  ///< standard deviation of a box edge / height of the box
  double confusion = 0.03;   ///< share of detections with a wrong label
  double false_per_image = 0.05;      ///< mean number of false boxes
  bool heading = false;               ///< the detector estimates headings of vehicles
  double heading_noise = radians(8);  ///< [rad] 16 bins of 22.5 deg and an error (method.md 7)
  double heading_flip = 0.1;          ///< share of headings reversed by 180 deg (method.md 7: p_f)

  void visit(ParamVisitor& v);
  CameraModel model() const;
};

/// Image box of an object.
struct ImageOutline {
  ObjectDetection::ImageBox box;  ///< clipped to the image
  double truncated = 0;           ///< [0, 1] share of the unclipped box outside of the image
};

/// Axes of an optical frame (x right, y down, z forward) in a frame with x forward, y left, z up.
Pose3 opticalAxes();

/// KITTI's alpha: rotation about the optical y axis, seen along the line of sight.
double observationAngle(const Pose3& T_camera_object);

/// Recall of a wholly visible object by the height [px] of its box, in clear air by day.
double boxRecall(const CameraParams& params, double height);
/// Share of its recall that a detector has left at a contrast C/C0:
/// clip((C/C0 - 0.05) / 0.2, 0, 1) (method.md 9.9).
double recallAtContrast(double contrast);
/// The same where the air's optical depth lowers the contrast to exp(-depth).
double contrastRecall(double optical_depth);

/// Effect of weather on detections; empty: clear air by day.
using CameraHook = std::function<void(CameraLook&, Rng&)>;

/// Where a mirror shows a point [m, world]; empty: no mirror.
using MirrorImage = std::function<Vector3(const Vector3&)>;

/// Empty if the object is outside of the image. `T_world_camera`: optical frame. In a panorama the
/// box of an object on the seam extends beyond the right border and is not truncated.
std::optional<ImageOutline> imageOutline(const World& world, std::size_t object, double t,
                                         const CameraModel& camera, const Pose3& T_world_camera,
                                         const MirrorImage& mirror = {});

/// Detections at t [s]; the caster must be set to that time.
ObjectDetections detectBoxes(const LidarCaster& caster, double t, const CameraParams& params,
                             const Pose3& T_world_camera, const RngKey& key,
                             const CameraHook& hook = {});

}  // namespace perception
