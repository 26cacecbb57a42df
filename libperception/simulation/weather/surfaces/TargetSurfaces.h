#pragma once
#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

/// Factor on the reflectivity of objects that are wet, or of whose surface snow covers a share.
double objectFactor(bool wet, double snow_cover);

/// Water or snow on objects (method.md 9.9): their reflectivity for lidars; cameras miss more of
/// the cars that snow covers.
class TargetSurfaces final : public SimulatedWeather {
 public:
  TargetSurfaces(bool wet, double snow_cover);  ///< [0, 1] share of the surfaces under snow

  using SimulatedWeather::alter;
  void alter(const SensorParams&, LidarPulse& pulse, Rng&) const override;
  void alter(const SensorParams&, CameraLook& look, Rng&) const override;
  bool actsOnPulses() const override { return true; }

 private:
  double factor_;  // on the reflectivity of objects and grass
  double ground_;  // of the road
  double recall_;
};

}  // namespace perception
