#pragma once
#include <memory>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A spherical image (equirectangular, width = 2 height, the full circle) split into rectified
/// tiles for detectors of pinhole images: eight tiles of 90 degrees, 45 degrees apart, each a
/// quarter as wide as the panorama, as in [radecki2016] (1k to 8k: tiles of 256 to 2048 pixels). An
/// object of less than 45 degrees is complete in at least one tile. method.md 8.8.
class Panorama {
 public:
  static constexpr int kTiles = 8;

  /// `width` [px] of the panorama, a multiple of 8; otherwise throws DataError.
  explicit Panorama(int width);
  ~Panorama();
  Panorama(Panorama&&) noexcept;
  Panorama& operator=(Panorama&&) noexcept;

  const CameraModel& camera() const { return camera_; }           ///< of the whole panorama
  const CameraModel& tileCamera() const { return tile_camera_; }  ///< of each tile: a pinhole
  /// Azimuth [rad] of a tile's axis, clockwise (to the right) from the panorama's middle column.
  static double tileAzimuth(int tile);

  /// The rectified image of a tile; empty when the panorama has another size.
  Raster tile(const Raster& panorama, int tile) const;

  /// Converts a box of a tile to the panorama by azimuths and elevations. It may extend beyond the
  /// panorama's right border but never begins left of 0. A lower edge at the tile's border is moved
  /// to the panorama's: it is truncated.
  ObjectDetection::ImageBox toPanorama(const ObjectDetection::ImageBox& box, int tile) const;

  /// Merges the detections of all tiles (kTiles lists): in pixels of the panorama, one per object,
  /// best score first. Observation angles (headings) do not depend on the tile.
  ObjectDetections merge(const std::vector<std::vector<ObjectDetection>>& tiles) const;

 private:
  struct Maps;
  CameraModel camera_, tile_camera_;
  std::unique_ptr<const Maps> maps_;  ///< the same for all tiles, up to a rotation
};

/// Intersection of two boxes in a full panorama, over their union and over the smaller box.
struct BoxOverlap {
  double of_union = 0, of_smaller = 0;  ///< [0, 1]
};
BoxOverlap panoramaOverlap(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b,
                           double width);

}  // namespace perception
