#include "libperception/pipeline/watches/InputWatch.h"

#include <gtest/gtest.h>

#include "tests/support/StartStamp.h"

namespace perception {
namespace {

SensorFrame scanWith(const std::vector<float>& intensity) {
  SensorFrame frame;
  frame.sensor = "LIDAR", frame.stamp = test::kStart;
  LidarCloud cloud;
  for (std::size_t i = 0; i < intensity.size(); ++i) {
    cloud.x.push_back(10), cloud.y.push_back(0.01f * static_cast<float>(i)), cloud.z.push_back(0);
  }
  cloud.ring.assign(cloud.size(), 3), cloud.time_offset.assign(cloud.size(), 0);
  cloud.intensity = intensity;
  frame.data = std::move(cloud);
  return frame;
}

std::vector<float> ramp() {
  std::vector<float> values;
  for (int i = 0; i < 40; ++i) values.push_back(static_cast<float>(i) / 255);
  return values;
}

TEST(InputWatch, IntensitiesThatTellNothingAreTakenOut) {
  EventLog events;
  InputWatch watch(events);
  for (int k = 0; k < 10; ++k) {
    SensorFrame flat = scanWith(std::vector<float>(40, 0.f));
    watch.apply(flat);
    EXPECT_TRUE(std::get<LidarCloud>(flat.data).intensity.empty()) << "from the first scan on";
  }
  EXPECT_EQ(events.counts().at(event_kind::kLidarInputs), 1u) << "said once";
  EXPECT_EQ(events.warnings(), 0u);
  EXPECT_NE(events.text(test::kStart).find("intensity is one value for all returns"),
            std::string::npos);
}

TEST(InputWatch, OfALidarThatGivesAllNothingIsSaid) {
  EventLog events;
  InputWatch watch(events);
  for (int k = 0; k < 10; ++k) {
    SensorFrame frame = scanWith(ramp());
    watch.apply(frame);
    EXPECT_EQ(std::get<LidarCloud>(frame.data).intensity, ramp());
  }
  EXPECT_TRUE(events.counts().empty());
}

}  // namespace
}  // namespace perception
