#pragma once
#include <mrpt/obs/CObservation.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "studies/ResolutionReport.h"

namespace perception {

/// Which INI tracks, and which of its sensors takes the panorama's boxes.
struct ResolutionSite {
  std::string file;                    ///< INI of the vehicle
  std::string camera = "CAMERA_PANO";  ///< its [sensor.LABEL] of kind boxes
  std::vector<std::string> settings;   ///< section.key=value
};

/// All sensor sets of one world side by side, in the order of the table of rates of [radecki2016],
/// each with a pipeline of its own: C-1k+R ..., L+R, C+L+R at the best resolution.
class ResolutionStreams {
 public:
  /// `letters` (C, L, R) of the sensors that there are besides the camera, `resolutions` of that;
  /// `log_odds`: the scores of its boxes are log-odds, and what is rather wrong than right is none.
  ResolutionStreams(const ResolutionSite& site, const std::set<char>& letters,
                    const std::vector<int>& resolutions, bool log_odds);
  ~ResolutionStreams();

  /// To the sets with that camera; to all with resolution -1.
  void give(const mrpt::obs::CObservation& observation, int resolution);
  /// At the end. Throws DataError when a set saw nothing.
  std::vector<ResolutionRun> finish();

 private:
  class Stream;
  std::vector<std::unique_ptr<Stream>> streams_;
};

}  // namespace perception
