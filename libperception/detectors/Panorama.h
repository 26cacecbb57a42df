#pragma once
#include <memory>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A spherical image (equirectangular, width = 2 height, the full circle) cut into rectilinear
/// tiles for detectors that know ordinary pictures only: eight tiles of 90 degrees, 45 degrees
/// apart, each a quarter as wide as the panorama, as in [radecki2016] (1k to 8k: tiles of 256 to
/// 2048 pixels). Every object of less than 45 degrees is whole in one tile at least. method.md 8.8.
class Panorama {
 public:
  static constexpr int kTiles = 8;

  /// `width` [px] of the panorama, a multiple of 8; anything else is a DataError.
  explicit Panorama(int width);
  ~Panorama();
  Panorama(Panorama&&) noexcept;
  Panorama& operator=(Panorama&&) noexcept;

  const CameraModel& camera() const { return camera_; }           ///< of the whole panorama
  const CameraModel& tileCamera() const { return tile_camera_; }  ///< of each tile: a pinhole
  /// [rad] of a tile's axis, clockwise (to the right) off the panorama's middle column.
  static double tileAzimuth(int tile);

  /// The rectilinear picture; empty when the panorama has another size.
  Raster tile(const Raster& panorama, int tile) const;

  /// A box of a tile as azimuths and elevations: a box of the panorama, which may reach over its
  /// right end (columns beyond the width) but never begins left of it. A lower edge at the tile's
  /// end becomes the panorama's: the foot was not seen.
  ObjectDetection::ImageBox toPanorama(const ObjectDetection::ImageBox& box, int tile) const;

  /// The detections of all tiles (kTiles lists) as those of one camera: in the panorama's pixels,
  /// each object once, best score first. Observation angles (headings) hold in any tile.
  ObjectDetections merge(const std::vector<std::vector<ObjectDetection>>& tiles) const;

 private:
  struct Maps;
  CameraModel camera_, tile_camera_;
  std::unique_ptr<const Maps> maps_;  ///< one for all tiles: they see the same strip, turned
};

/// Width and height that two boxes share in a closed panorama, as intersection over union, and over
/// the smaller one.
struct BoxOverlap {
  double of_union = 0, of_smaller = 0;  ///< [0, 1]
};
BoxOverlap panoramaOverlap(const ObjectDetection::ImageBox& a, const ObjectDetection::ImageBox& b,
                           double width);

}  // namespace perception
