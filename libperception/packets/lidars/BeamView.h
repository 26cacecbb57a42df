#pragma once
#include <optional>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/packets/lidars/Beams.h"

namespace perception {

/// A cloud as the beams of a device see it: each return belongs to the beam of the nearest
/// elevation.
class BeamView {
 public:
  struct Seen {
    double range = 0;     ///< [m]
    float intensity = 0;  ///< [0, 1]
  };

  BeamView(const LidarCloud& cloud, const std::vector<BeamAngles>& beams);
  /// The nearest return of a beam within half a step of a clockwise azimuth [deg] in [0, 360).
  std::optional<Seen> at(std::size_t beam, double azimuth, double step) const;

 private:
  struct Return {
    double azimuth;  ///< [deg] clockwise
    Seen seen;
  };
  std::vector<std::vector<Return>> returns_;  ///< by beam, in order of azimuth
};

}  // namespace perception
