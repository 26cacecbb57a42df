#pragma once
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/simulation/world/Lighting.h"

namespace perception {

class LidarCaster;
struct CameraView;

/// A camera with rendered images: [sensor.LABEL] kind = camera_images: a pinhole, or at 360 degrees
/// a panorama of the whole sphere (equirectangular), twice as wide as high. Defaults: the smallest
/// panorama of [radecki2016].
struct ImageCameraParams {
  int width = 1024, height = 512;  ///< [px] height: of a pinhole's image
  double fov = kTwoPi;             ///< [rad] horizontal

  void visit(ParamVisitor& v);
  bool panorama() const { return fov >= kTwoPi - 1e-9; }
  /// Pixel centers at whole numbers.
  CameraModel model() const;
};

/// An image, and the object at the center of each pixel.
struct RenderedImage {
  Raster raster;
  /// Index into the scenario's objects, BeamHit::kRoad or kNothing; one per pixel, rows from the
  /// top.
  std::vector<int> objects;
};

/// Renders the image at t [s], to which the caster must be set: one ray per pixel, four where
/// neighbors differ, each with secondary rays towards the sun and, from the ground, straight up
/// (method.md 9.11). `T_world_camera`: optical frame. The ego vehicle is not rendered.
/// Byte-identical for any number of threads. `view`, unless null, gets the same before its bytes,
/// for weather that acts on images; its velocity is left to the caller.
RenderedImage renderImage(const LidarCaster& caster, double t, const CameraModel& camera,
                          const Lighting& light, const Pose3& T_world_camera,
                          CameraView* view = nullptr);

}  // namespace perception
