// [ego] source = radar on recordings: the vehicle's speed from range rates alone.
#include <cmath>

#include "libperception/importers/street_sets/VodFiles.h"
#include "libperception/odometry/RadarOdometry.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

using test::sharedData;

class RadarEgo : public test::ImportRun {
 protected:
  struct Errors {
    double largest = 0, rms_rate = 0;  ///< [m/s] of the speed; [rad/s]
    int instants = 0;
  };
  /// From half a second on; frames of one instant by index.
  Errors errorsOf(const std::vector<std::vector<SensorFrame>>& radars) {
    RadarOdometry odometry;
    Errors errors;
    for (std::size_t k = 0; k < radars[0].size(); ++k) {
      std::vector<const SensorFrame*> frames;
      for (const auto& radar : radars) frames.push_back(&radar.at(k));
      odometry.update(frames);
      const SensorFrame& frame = *frames[0];
      if (frame.stamp - radars[0][0].stamp < 0.5) continue;
      const RadarMotion& motion = odometry.motion();
      errors.largest = std::max(errors.largest,
                                std::abs(motion.mean.head<2>().norm() - frame.ego.velocity.norm()));
      errors.rms_rate += std::pow(motion.mean.z() - frame.ego.yaw_rate, 2);
      ++errors.instants;
    }
    errors.rms_rate = std::sqrt(errors.rms_rate / std::max(1, errors.instants));
    RecordProperty("largest_speed_error_mps", std::to_string(errors.largest));
    RecordProperty("yaw_rate_rms_radps", std::to_string(errors.rms_rate));
    return errors;
  }
};

TEST_F(RadarEgo, AimotivesSpeedWithinATenthOfAMeterASecond) {
  NEEDS_SHARED_DATA("aimotive");
  ASSERT_EQ(import("aimotive", {"--dir", sharedData("aimotive")}), 0) << error_;
  const auto front = framesOf("RADAR_FRONT"), rear = framesOf("RADAR_REAR");
  ASSERT_EQ(front.size(), rear.size());
  const Errors both = errorsOf({front, rear});
  EXPECT_GT(both.instants, 15);
  EXPECT_LT(both.largest, 0.1);
  EXPECT_LT(both.rms_rate, 0.03);  // measured .021; that of the labels is known to .004
  EXPECT_LT(errorsOf({front}).largest, 0.1);
}

TEST_F(RadarEgo, VodsSpeedIsThatOfItsOwnCompensation) {
  NEEDS_SHARED_DATA("vod_radar");
  for (const char* name : {"00549", "01047"}) {
    const auto points =
        readVodRadar(sharedData(std::string("vod_radar/radar_points/") + name + ".bin"));
    SensorFrame frame;
    frame.stamp = Stamp{1'000'000'000};
    frame.data = returnsOf(points, false);
    RadarOdometry odometry;
    ASSERT_TRUE(odometry.update({&frame})) << name;
    const double speed = ownVelocity(points).norm();
    RecordProperty(std::string("speed_") + name, std::to_string(speed));
    EXPECT_NEAR(odometry.motion().mean.head<2>().norm(), speed, 0.1) << name;
  }
}

}  // namespace
}  // namespace perception
