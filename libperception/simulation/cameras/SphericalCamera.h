#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/cameras/CameraBoxes.h"

namespace perception {

class LidarCaster;
enum class ObjectKind;

/// A panoramic camera with the detector of [radecki2016] for cars and persons, in a [sensor.LABEL]
/// section: boxes in pixels of the equirectangular panorama. `resolution` sets size, ranges and
/// false boxes (tables of resolutions and of detections per image in [radecki2016]). Edge noise
/// assumed.
struct SphericalCameraParams {
  enum class Resolution { k1k, k2k, k4k, k8k };
  Resolution resolution = Resolution::k2k;
  int width = 2048, height = 1024;                  ///< [px]
  double car_range = 15, person_range = 10;         ///< [m] up to which recall holds [radecki2016]
  double false_per_image = 0.12;                    ///< mean number of false boxes, see .cpp
  double car_recall = 0.85, person_recall = 0.70;   ///< within range, sunny [radecki2016]
  double bus_recall = 0.60, cyclist_recall = 0.60;  ///< (method.md 2.3)
  double edge_noise = 0.05;  ///< of a box edge, as a share of the box's height
  bool heading = true;       ///< orientation of cars
  int heading_bins = 16;     ///< of the observation angle (16 models [radecki2016]); 0: none
  double heading_noise = radians(4.7);  ///< [rad] before binning; with 16 bins 8 deg (method.md 7)
  double heading_flip = 0.2;            ///< share reversed by 180 deg (method.md 7: p_f)

  void setResolution(Resolution r);  ///< also sets all values that depend on it
  void visit(ParamVisitor& v);
  CameraModel model() const;
};

/// Recall of a wholly visible object at a range [m], in clear air by day.
double panoramaRecall(const SphericalCameraParams& params, ObjectKind kind, double range);

/// A box of an object anywhere around as the panorama has it: rows inside the image, the left edge
/// in [0, width), the right edge beyond the seam if need be.
ObjectDetection::ImageBox onPanorama(ObjectDetection::ImageBox box, const CameraModel& camera);

/// Detections at t [s]; the caster must be set to that time. Labels Car and Pedestrian; a cyclist
/// is mostly labeled Pedestrian, a bus Car. A box over the seam begins inside the image and ends
/// beyond its width.
ObjectDetections detectPanorama(const LidarCaster& caster, double t,
                                const SphericalCameraParams& params, const Pose3& T_world_camera,
                                const RngKey& key, const CameraHook& hook = {});

}  // namespace perception
