// Simulated boxes of a detector, through import and tracker.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "libperception/core/math/Random.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr double kLane = 3.5;                               // [m] to the left
constexpr double kSpeeds[] = {10, 15, 20, 24, 30, 35, 40};  // [m/s]

/// 200 cars that come towards a standing vehicle one after the other, beside three parked ones.
class OncomingTraffic : public test::ImportRun {
 protected:
  struct Place {
    int encounter;
    double x;  ///< [m]
  };
  void SetUp() override {
    write("calib.txt",
          "P2: 700 0 600 0 0 700 180 0 0 0 1 0\nR0_rect: 1 0 0 0 1 0 0 0 1\n"
          "Tr_velo_to_cam: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
    Rng rng({1, 0, 0, 0});
    std::ostringstream boxes, poses;
    const auto box = [&](double x, double y, double yaw, double score) {
      boxes << fmt::format(
          "{} Car -1 -1 -10 0 0 100 100 1.5 1.8 4.2 {:.3f} 1.73 {:.3f} {} {:.2f}\n", places_.size(),
          -y + rng.normal(0, 0.08), x + rng.normal(0, 0.1), yaw, rng.normal(score, 1));
    };
    for (int encounter = 0; encounter < 200; ++encounter) {
      for (double x = 75; x > -30; x -= 0.1 * kSpeeds[encounter % 7]) {
        if (x > 4 && rng.uniform() < 0.95) box(x, kLane, kPi / 2, 5);
        for (const Vector2& parked : {Vector2(15, -4), Vector2(30, -4), Vector2(45, 8)})
          if (rng.uniform() < 0.95) box(parked.x(), parked.y(), -kPi / 2, 5);
        if (rng.uniform() < 0.5) box(rng.uniform(10, 70), rng.uniform(-20, 20), 0, -1);
        places_.push_back({encounter, x});
        poses << "1 0 0 0 0 1 0 0 0 0 1 0\n";
      }
    }
    write("boxes.txt", boxes.str());
    write("poses.txt", poses.str());
  }
  std::vector<Place> places_;  ///< by frame
};

TEST_F(OncomingTraffic, KeepsItsIdentityFrom10To40MetersASecond) {
  ASSERT_EQ(import("kitti", {"--calib", file("calib.txt"), "--poses", file("poses.txt"),
                             "--detections", "boxes3d:Car=" + file("boxes.txt")}),
            0)
      << error_;
  int switches = 0, seen = 0, tracked = 0, encounter = -1;
  std::uint64_t id = 0;
  for (const Scene& scene : track("any-detector.ini", "L")) {
    const Place& place = places_[static_cast<std::size_t>(scene.frame)];
    if (place.x < 4) continue;
    if (place.encounter != encounter) encounter = place.encounter, id = 0;
    ++seen;
    for (const SceneObject& object : scene.objects) {
      if ((object.position.head<2>() - Vector2(place.x, kLane)).norm() > 2) continue;
      ++tracked;
      switches += id != 0 && object.id != id;
      id = object.id;
    }
  }
  EXPECT_EQ(encounter, 199);
  EXPECT_EQ(switches, 0) << "of 200 encounters";
  EXPECT_GE(tracked, (94 * seen) / 100);
}

}  // namespace
}  // namespace perception
