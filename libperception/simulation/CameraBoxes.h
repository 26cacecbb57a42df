#pragma once
#include <functional>
#include <optional>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Random.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

class LidarCaster;
class World;

/// A camera with an image detector behind it, in a [sensor.LABEL] section. Defaults: a recent
/// detector on KITTI's camera [geiger2012], rates assumed; the part models of [radecki2016] are
/// weaker (recall, orientation).
struct CameraParams {
  int width = 1242, height = 375;            ///< [px] KITTI
  double fov = radians(81);                  ///< [rad] horizontal; KITTI: f = 721 px
  double recall = 0.9;                       ///< of an object that is wholly visible and large
  double min_pixels = 20, full_pixels = 40;  ///< [px] box height: none below, all of recall above
  double edge_noise = 0.03;                  ///< of a box edge, as a share of the box's height
  double confusion = 0.03;            ///< share of detections with the label of another class
  double false_per_image = 0.05;      ///< boxes where nothing is
  bool heading = false;               ///< detector tells the orientation of vehicles
  double heading_noise = radians(8);  ///< [rad] 16 bins of 22.5 deg and an error (method.md 7)
  double heading_flip = 0.1;          ///< share reversed by 180 deg (method.md 7: p_f)

  void visit(ParamVisitor& v);
  CameraModel model() const;
};

/// The object's outline in the image.
struct ImageOutline {
  ObjectDetection::ImageBox box;  ///< clipped to the image
  double truncated = 0;           ///< [0, 1] share of the whole box outside
};

/// Axes of an optical frame (x right, y down, z forward) in a frame with x forward, y left, z up.
Pose3 opticalAxes();

/// KITTI's alpha: rotation about the optical y axis, seen along the line of sight.
double observationAngle(const Pose3& T_camera_object);

/// Changes what a detector sees; empty: clear air by day.
using CameraHook = std::function<void(CameraLook&, Rng&)>;

/// Empty when the object lies outside the image. `T_world_camera`: optical frame. In a panorama
/// the box of an object on the seam reaches beyond the border and nothing is truncated.
std::optional<ImageOutline> imageOutline(const World& world, std::size_t object, double t,
                                         const CameraModel& camera, const Pose3& T_world_camera);

/// The detector's answer at t [s]; the caster stands at that time.
ObjectDetections detectBoxes(const LidarCaster& caster, double t, const CameraParams& params,
                             const Pose3& T_world_camera, const RngKey& key,
                             const CameraHook& hook = {});

}  // namespace perception
