#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libperception/core/math/Random.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/world/Lighting.h"

namespace perception {

/// What a camera sees before the bytes of its image: rendered, or decoded from a recording
/// (method.md 9.14). Weather alters both in the same way.
struct CameraView {
  static constexpr float kSky = 1e6F;  ///< [m] range of pixels that show the sky

  CameraModel camera;
  Pose3 T_world_camera = Pose3::Identity();  ///< optical frame
  Vector3 velocity = Vector3::Zero();        ///< [m/s] of the camera, world
  Lighting light;                            ///< in which it was taken
  std::vector<Eigen::Vector3f> linear;  ///< display values, red, green, blue; rows from the top
  std::vector<float> range;             ///< [m] of the surface in each pixel; or kSky

  /// Direction of a pixel, unit vector, world.
  Vector3 ray(double u, double v) const;
  /// Pixel that shows a point [m, camera frame]; empty: behind the camera.
  std::optional<Vector2> pixelOf(const Vector3& point) const;
};

/// Direction of a pixel in the optical frame, unit vector.
Vector3 opticalRay(const CameraModel& camera, double u, double v);

/// Shot and read noise of the sensor at the light's gain (method.md 9.14); none by day, at gain 1.
void addSensorNoise(CameraView& view, Rng& rng);

/// The view as an image of three channels.
Raster rasterOf(const CameraView& view);

}  // namespace perception
