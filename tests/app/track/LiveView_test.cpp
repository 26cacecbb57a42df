// A run that is watched: perception-track --serve.
#include "libperception/live/LiveView.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "libperception/app/track/TrackApp.h"
#include "tests/app/LogFaults.h"

namespace perception::test {
namespace {

TEST(LiveView, ARunThatIsServedHasTheSameBytes) {
  const auto log = demoStart(3);
  Tracking plain, served;
  ASSERT_EQ(plain.track(log).code, 0) << plain.ended.err;
  ASSERT_EQ(served.track(log, {"--serve", "0"}).code, 0) << served.ended.err;
  for (const char* table : {"/tracks.csv", "/scenes.csv", "/events.jsonl", "/effective.ini"})
    EXPECT_EQ(contentOf(plain.dir + table), contentOf(served.dir + table)) << table;
}

TEST(LiveView, AnAddressThatOthersReachNeedsAToken) {
  Tracking t;
  EXPECT_EQ(t.track(kDemoLog, {"--serve", "0", "--serve-address", "0.0.0.0"}).code, 64);
  EXPECT_NE(t.ended.err.find("--serve-token"), std::string::npos) << t.ended.err;
  EXPECT_EQ(t.track(kDemoLog, {"--serve", "0", "--serve-address", "here"}).code, 64);
  EXPECT_EQ(t.track(kDemoLog, {"--serve", "0", "--serve-token", t.folder / "none"}).code, 66);
  std::ofstream(t.folder / "token") << "short\n";
  EXPECT_EQ(t.track(kDemoLog, {"--serve", "0", "--serve-token", t.folder / "token"}).code, 65);
  EXPECT_EQ(t.track(kDemoLog, {"--serve", "70000"}).code, 64);
}

TEST(LiveView, ALogIsShownAtItsOwnSpeed) {
  Tracking t;
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(t.track(demoStart(1.5), {"--serve", "0", "--serve-speed", "0.5"}).code, 0)
      << t.ended.err;
  EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

}  // namespace
}  // namespace perception::test
