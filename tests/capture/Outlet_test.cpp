#include "libperception/capture/Outlet.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <future>

#include "libperception/sensors/observations/CObservationLidarScan.h"

namespace perception {
namespace {

Drivers::Arrival arrivalOf(const std::string& label) {
  auto observation = std::make_shared<mrpt::obs::CObservationOdometry>();
  observation->sensorLabel = label;
  return {observation, 0, {}};
}

TEST(Outlet, TakesAllInOrderBeforeItCloses) {
  std::string taken;
  Outlet outlet(
      {0, [&](const auto& a, std::uint64_t) { taken += a.observation->sensorLabel; }, {}, 0, {}});
  for (const char* label : {"a", "b", "c", "a"}) outlet.put(arrivalOf(label));
  outlet.close();
  EXPECT_EQ(taken, "abca");
  EXPECT_EQ(outlet.dropped(), 0U);
}

TEST(Outlet, LeavesOutTheOldestOfTheSensorWithMostWaiting) {
  std::promise<void> go;
  auto wait = go.get_future().share();
  std::string taken;
  std::uint64_t dropped = 0;
  Outlet outlet({3,
                 [&](const auto& a, std::uint64_t left_out) {
                   if (a.observation->sensorLabel == "first") return wait.wait();
                   taken += a.observation->sensorLabel;
                   dropped = left_out;
                 },
                 {},
                 0,
                 {}});
  outlet.put(arrivalOf("first"));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // it is being taken now
  for (const char* label : {"pose", "lidar", "lidar", "lidar", "pose"})
    outlet.put(arrivalOf(label));
  go.set_value();
  outlet.close();
  EXPECT_EQ(taken, "poselidarpose");
  EXPECT_EQ(dropped, 2U);
}

TEST(Outlet, TellsWhatDidNotFitInItsBytes) {
  std::promise<void> go;
  auto wait = go.get_future().share();
  std::string taken, left_out;
  Outlet::Params params;
  params.take = [&](const auto& a, std::uint64_t) {
    wait.wait();
    taken += a.observation->sensorLabel;
  };
  params.most_bytes = 3 * sizeInMemory(*arrivalOf("a").observation);
  params.left_out = [&](const auto& a) { left_out += a.observation->sensorLabel; };
  Outlet outlet(params);
  outlet.put(arrivalOf("a"));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // it is being taken now
  for (const char* label : {"b", "c", "b", "b", "b"}) outlet.put(arrivalOf(label));
  EXPECT_EQ(left_out, "bb");
  go.set_value();
  outlet.close();
  EXPECT_EQ(taken, "acbb");
  EXPECT_EQ(outlet.dropped(), 2U);
}

TEST(Outlet, OfWhatFillsItsBytesTheLargestSensorIsLeftOut) {
  std::promise<void> go;
  auto wait = go.get_future().share();
  std::string left_out;
  Outlet::Params params;
  params.take = [&](const auto&, std::uint64_t) { wait.wait(); };
  const auto scan = std::make_shared<CObservationLidarScan>();
  scan->sensorLabel = "L";
  scan->cloud.x.resize(10000);
  params.most_bytes = sizeInMemory(*scan) * 3 / 2;
  params.left_out = [&](const auto& a) { left_out += a.observation->sensorLabel; };
  Outlet outlet(params);
  outlet.put(arrivalOf("first"));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // it is being taken now
  for (int i = 0; i < 5; ++i) outlet.put(arrivalOf("p"));      // more of them, and small
  outlet.put({scan, 0, {}});
  outlet.put({scan, 0, {}});
  EXPECT_EQ(left_out, "L");
  go.set_value();
  outlet.close();
}

TEST(Outlet, ThrowsWhatItsConsumerThrew) {
  Outlet outlet(
      {0, [](const auto&, std::uint64_t) { throw std::runtime_error("full"); }, {}, 0, {}});
  outlet.put(arrivalOf("a"));
  EXPECT_THROW(outlet.close(), std::runtime_error);
  EXPECT_THROW(outlet.check(), std::runtime_error);
}

}  // namespace
}  // namespace perception
