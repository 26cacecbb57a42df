#include "libperception/doctor/motion/RadarVelocity.h"

#include <gtest/gtest.h>

#include "tests/doctor/TestDrive.h"

namespace perception {
namespace {

using test::stampAt;

TEST(RadarVelocity, ReturnsThatDisagreeGiveNone) {
  RadarReturns radar;
  for (int i = 0; i < 12; ++i) {
    RadarReturn r;
    r.range = 20, r.bearing = 0.1 * (i - 6), r.range_rate = 3.0 * ((i * 5) % 12);
    radar.returns.push_back(r);
  }
  EXPECT_FALSE(radarVelocity(radar, stampAt(0)));
}

}  // namespace
}  // namespace perception
