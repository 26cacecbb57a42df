#include "libperception/simulation/weather/surfaces/TargetSurfaces.h"

#include <gtest/gtest.h>

#include "tests/simulation/weather/WeatherBeams.h"

namespace perception {
namespace {

double reflectivityOf(const TargetSurfaces& surfaces, int object) {
  LidarPulse pulse = test::wallPulse(20);
  pulse.hit.object = object;
  if (object < 0) pulse.hit.material = Material::kRoad;
  Rng rng({1, 0, 0, 0});
  surfaces.alter(SensorParams(), pulse, rng);
  return pulse.reflectivity / 0.3;
}

TEST(TargetSurfaces, WetObjectsAreDarkAndSnowyOnesBright) {
  EXPECT_NEAR(reflectivityOf({true, 0}, 0), 0.6, 1e-9);
  EXPECT_NEAR(reflectivityOf({false, 1}, 0), 1.3, 1e-9);
  EXPECT_NEAR(reflectivityOf({true, 0.5}, 0), 0.95, 1e-9);
}

TEST(TargetSurfaces, FilmOfTheRoadIsNotTheirs) {
  EXPECT_EQ(reflectivityOf({true, 0}, BeamHit::kRoad), 1);
  EXPECT_NEAR(reflectivityOf({false, 1}, BeamHit::kRoad), 1.3, 1e-9);
}

TEST(TargetSurfaces, CamerasMissAFifthUnderSnow) {
  CameraLook look;
  look.chance = 1;
  Rng rng({1, 0, 0, 0});
  TargetSurfaces(false, 1).alter(SensorParams(), look, rng);
  EXPECT_NEAR(look.chance, 0.8, 1e-12);
}

}  // namespace
}  // namespace perception
