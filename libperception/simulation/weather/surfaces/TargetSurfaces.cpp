#include "libperception/simulation/weather/surfaces/TargetSurfaces.h"

namespace perception {
namespace {

constexpr double kWet = 0.6, kSnowy = 1.3, kSnowyRecall = 0.8;  // method.md 9.9, assumed

}  // namespace

double objectFactor(bool wet, double snow_cover) {
  return snow_cover * kSnowy + (1 - snow_cover) * (wet ? kWet : 1);
}

TargetSurfaces::TargetSurfaces(bool wet, double snow_cover)
    : factor_(objectFactor(wet, snow_cover)),
      ground_(1 + snow_cover * (kSnowy - 1)),
      recall_(1 - snow_cover * (1 - kSnowyRecall)) {}

// The film on a wet road is WetGround's.
void TargetSurfaces::alter(const SensorParams&, LidarPulse& pulse, Rng&) const {
  const bool road = pulse.hit.object == BeamHit::kRoad && pulse.hit.material != Material::kGrass;
  pulse.reflectivity *= road ? ground_ : factor_;
}

void TargetSurfaces::alter(const SensorParams&, CameraLook& look, Rng&) const {
  look.chance *= recall_;
}

}  // namespace perception
