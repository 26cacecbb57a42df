#pragma once
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/importers/clouds/ImportClouds.h"

namespace perception {

/// A scan's file, and the place of its sensor [m] in the fixed frame of the poses.
struct PlacedFile {
  std::string path;
  Vector3 place = Vector3::Zero();
};

/// Whether scans are in the frame of the poses, and not in the sensor's: the returns lie about the
/// sensor's place in that frame and not about the origin (medians of their distances differ by a
/// factor of 3), in each of five scans spread over those that were made 30 m or more from the
/// origin and half as far as the farthest, of which there have to be three. Throws DataError: a
/// file, or the places are so far from the origin that float32 is too coarse.
bool areInWorld(const std::vector<PlacedFile>& scans, const CloudFormat& format);

}  // namespace perception
