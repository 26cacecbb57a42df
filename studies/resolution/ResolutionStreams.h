#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "studies/resolution/ResolutionReport.h"

namespace perception {

/// Site INI, and its sensor for the panorama's boxes.
struct ResolutionSite {
  std::string file;                    ///< site INI
  std::string camera = "CAMERA_PANO";  ///< its [sensor.LABEL] of kind boxes
  std::vector<std::string> settings;   ///< section.key=value
};

/// Tracks all sensor sets in parallel, in the order of the table of rates of [radecki2016], each
/// with its own pipeline: C-1k+R ..., L+R, C+L+R at the best resolution.
class ResolutionStreams {
 public:
  /// `letters` (C, L, R) of the other available sensors, `resolutions` of the camera.
  ResolutionStreams(const ResolutionSite& site, const std::set<char>& letters,
                    const std::vector<int>& resolutions);
  ~ResolutionStreams();

  /// Passes an observation to the sets with that camera; with resolution -1 to all.
  void give(const mrpt::obs::CObservation& observation, int resolution);
  /// Call at the end. Throws DataError if a set has no scene.
  std::vector<ResolutionRun> finish();

 private:
  class Stream;
  std::vector<std::unique_ptr<Stream>> streams_;
};

}  // namespace perception
