// Logs whose clock jumps.
#include <gtest/gtest.h>

#include <chrono>

#include "libperception/app/track/TrackApp.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "tests/app/LogFaults.h"

namespace perception::test {
namespace {

/// The demo's first seconds with a gap in the clock after two of them.
std::vector<Observation> withGap(double gap) {
  auto log = demoStart(4);
  const Stamp first = *toStamp(log.front()->timestamp);
  for (auto& o : log) {
    const Stamp stamp = *toStamp(o->timestamp);
    if (stamp - first > 2) o->timestamp = fromStamp(stamp + gap);
  }
  return log;
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(TrackApp, AGapOfADayAWeekOrAYearIsOneEventAndCostsNoTime) {
  constexpr double kDay = 86400;
  Tracking whole;
  whole.track(demoStart(4));
  for (const double gap : {kDay, 7 * kDay, 365 * kDay}) {
    for (const std::vector<std::string>& options : {std::vector<std::string>{}, {"--rate", "10"}}) {
      Tracking t;
      EXPECT_LT(seconds([&] { t.track(withGap(gap), options); }), 20);
      ASSERT_EQ(t.ended.code, 0) << t.ended.err;
      EXPECT_EQ(t.events("clock_jump"), 1U);
      EXPECT_EQ(t.events("sensor_lost"), 0U);
      EXPECT_NEAR(static_cast<double>(t.scenes()), static_cast<double>(whole.scenes()), 2);
    }
  }
}

TEST(TrackApp, TwoThreadsGiveTheBytesOfOne) {
  for (const auto& log : {demoStart(4), withGap(86400), withGap(5)}) {
    for (const char* rate : {"0", "7"}) {
      Tracking one, two;
      ASSERT_EQ(one.track(log, {"--rate", rate, "--threads", "1"}).code, 0) << one.ended.err;
      ASSERT_EQ(two.track(log, {"--rate", rate, "--threads", "2"}).code, 0) << two.ended.err;
      for (const char* file : {"tracks.csv", "scenes.csv", "events.jsonl", "innovations.csv"})
        EXPECT_EQ(contentOf(one.dir + "/" + file), contentOf(two.dir + "/" + file)) << file;
    }
  }
}

TEST(TrackApp, NoObjectOutlivesAGapOfADay) {
  Tracking t;
  ASSERT_EQ(t.track(withGap(86400)).code, 0) << t.ended.err;
  const auto table = CsvTable::fromFile(t.dir + "/tracks.csv");
  std::set<std::uint64_t> before, after;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    (table.real(i, table.column("t")) < 1000 ? before : after)
        .insert(table.natural(i, table.column("id")));
  }
  EXPECT_GT(before.size(), 3U);
  EXPECT_GT(after.size(), 3U);
  for (const auto id : after) EXPECT_EQ(before.count(id), 0U) << id;
}

TEST(TrackApp, AClockThatGoesAheadByFiftyYearsIsAnEpoch) {
  Tracking t;
  ASSERT_EQ(t.track(withGap(50 * 365.25 * 86400)).code, 3) << t.ended.err;
  EXPECT_EQ(t.events("clock_jump"), 1U);
  EXPECT_NE(contentOf(t.dir + "/events.jsonl").find("the clock went ahead by 1577880000"),
            std::string::npos);
}

}  // namespace
}  // namespace perception::test
