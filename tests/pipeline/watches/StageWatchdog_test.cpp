#include "libperception/pipeline/watches/StageWatchdog.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>

namespace perception {
namespace {

using std::chrono::milliseconds;

/// Runs `work` under a watchdog of .1 s; the stage that it named, or "nothing".
template <class Work>
std::string hungStage(const Work& work) {
  RunTiming timing;
  std::promise<std::string> named;
  auto name = named.get_future();
  {
    StageWatchdog watchdog(timing, 0.1, [&](const std::string& s) { named.set_value(s); });
    work(timing);
  }
  return name.wait_for(milliseconds(0)) == std::future_status::ready ? name.get() : "nothing";
}

TEST(StageWatchdog, NamesTheStageThatDoesNotEnd) {
  EXPECT_EQ(hungStage([](RunTiming& timing) {
              const auto outer = timing.stage("filter");
              { const auto inner = timing.stage("lidar"); }
              std::this_thread::sleep_for(milliseconds(400));
            }),
            "filter");
}

TEST(StageWatchdog, WaitingForSensorsIsNoFault) {
  EXPECT_EQ(hungStage([](RunTiming& timing) {
              const auto scope = timing.stage("read");
              std::this_thread::sleep_for(milliseconds(400));
            }),
            "nothing");
}

TEST(StageWatchdog, ManyShortStagesAreNoFault) {
  EXPECT_EQ(hungStage([](RunTiming& timing) {
              for (int i = 0; i < 20; ++i) {
                const auto scope = timing.stage("filter");
                std::this_thread::sleep_for(milliseconds(20));
              }
            }),
            "nothing");
}

}  // namespace
}  // namespace perception
