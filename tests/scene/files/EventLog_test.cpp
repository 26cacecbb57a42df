#include "libperception/scene/files/EventLog.h"

#include <gtest/gtest.h>

#include "libperception/core/Error.h"
#include "tests/scene/SceneFixture.h"

namespace perception {
namespace {

using namespace test;

TEST(EventLog, WritesOneObjectALineInTheOrderOfAdd) {
  EventLog log;
  log.warn(Stamp{kFirstStamp.ns + 300000000}, event_kind::kDroppedPoints, "points out of range",
           {{"sensor", "LIDAR_TOP"}, {"points", 12}, {"range", 0.1}});
  log.add(kFirstStamp, event_kind::kTrackBorn, "first time in a scene", {{"id", 7}});
  log.add(std::nullopt, event_kind::kSensorIgnored, "not configured");
  EXPECT_EQ(
      log.text(kFirstStamp),
      R"({"t":0.3,"stamp":"1700000000.423456789","kind":"dropped_points","severity":"warning",)"
      R"("message":"points out of range","fields":{"sensor":"LIDAR_TOP","points":12,"range":0.1}})"
      "\n"
      R"({"t":0.0,"stamp":"1700000000.123456789","kind":"track_born","severity":"info",)"
      R"("message":"first time in a scene","fields":{"id":7}})"
      "\n"
      R"({"t":null,"stamp":null,"kind":"sensor_ignored","severity":"info","message":"not configured",)"
      R"("fields":{}})"
      "\n");
}

TEST(EventLog, ASingleFieldIsAnObjectToo) {
  EventLog log;
  log.warn(kFirstStamp, "x", "m", {{"sensor", "CAMERA"}});
  EXPECT_NE(log.text(kFirstStamp).find(R"("fields":{"sensor":"CAMERA"})"), std::string::npos);
}

TEST(EventLog, KeepsTheFirstWarningsAlsoWhenTheyAreWrittenAsTheyCome) {
  const test::TemporaryFolder folder;
  EventLog log;
  log.warn(kFirstStamp, "x", "one");
  log.writeTo(folder / "events.jsonl", kFirstStamp);
  for (const char* message : {"one", "two", "two", "three", "four"})
    log.warn(kFirstStamp, "x", message);
  EXPECT_EQ(log.firstWarnings(), (std::vector<std::string>{"one", "two", "three"}));
  EXPECT_EQ(log.warnings(), 6U);
  log.close();
}

TEST(EventLog, EventsThatAreHeldComeAfterTheLateOnes) {
  EventLog log, wanted;
  std::vector<std::string> told;
  log.tell([&](std::optional<Stamp>, const auto& event) { told.push_back(event.at("message")); });
  const auto add = [](EventLog& to, const char* message) { to.add(kFirstStamp, "x", message); };
  const std::vector<std::string> all = {"one", "two", "three", "four", "five", "six"};
  for (const std::string& message : all) add(wanted, message.c_str());
  add(log, "one");
  log.hold();
  add(log, "three");
  log.hold();
  add(log, "five");
  EXPECT_EQ(told, (std::vector<std::string>{"one"}));
  EXPECT_EQ(log.counts().at("x"), 3U) << "counted at once";
  log.release([&] { add(log, "two"); });
  EXPECT_EQ(told.size(), 3U) << "five waits for four";
  log.release([&] { add(log, "four"); });
  log.release([&] { add(log, "six"); });
  EXPECT_EQ(told, all);
  EXPECT_EQ(log.text(kFirstStamp), wanted.text(kFirstStamp));
}

TEST(EventLog, CountsByKindAndWarnings) {
  EventLog log;
  log.add(kFirstStamp, event_kind::kTrackBorn, "");
  log.add(kFirstStamp, event_kind::kTrackBorn, "");
  log.warn(kFirstStamp, event_kind::kEgoGap, "");
  EXPECT_EQ(log.counts(),
            (std::map<std::string, std::uint64_t>{{"ego_gap", 1}, {"track_born", 2}}));
  EXPECT_EQ(log.warnings(), 1u);
}

TEST(EventLog, KeepsABoundedNumberOfLinesAndSaysSo) {
  EventLog log(3);
  for (int i = 0; i < 10; ++i) log.add(kFirstStamp, "often", "again", {{"i", i}});
  const std::string text = log.text(kFirstStamp);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4);
  EXPECT_NE(text.find(R"("kind":"events_not_written")"), std::string::npos);
  EXPECT_NE(text.find(R"("fields":{"kind":"often","events":7})"), std::string::npos);
  EXPECT_EQ(log.counts().at("often"), 10u);
}

TEST(EventLog, TextThatIsNotUtf8DoesNotEndTheRun) {
  EventLog log;
  log.add(kFirstStamp, "x", "label \xff\xfe", {{"sensor", "\xc3"}});
  const auto line = nlohmann::json::parse(log.text(kFirstStamp));
  EXPECT_EQ(line["kind"], "x");
}

TEST(EventLog, AsTheyComeTheyAreTheSameBytesInAFile) {
  const TemporaryFolder folder;
  EventLog stored, written;
  for (EventLog* log : {&stored, &written}) {
    log->add(std::nullopt, event_kind::kSensorIgnored, "before the first stamp");
    if (log == &written) written.writeTo(folder / "events.jsonl", kFirstStamp);
    log->add(kFirstStamp, event_kind::kTrackBorn, "", {{"id", 1}});
    log->warn(Stamp{kFirstStamp.ns + 50000000}, event_kind::kEgoGap, "for 2 s");
  }
  written.close();
  EXPECT_EQ(readText(folder / "events.jsonl"), stored.text(kFirstStamp));
  EXPECT_EQ(written.counts(), stored.counts());
  EXPECT_EQ(written.warnings(), 1U);
}

TEST(EventLog, InAFileNoneIsOmitted) {
  const TemporaryFolder folder;
  EventLog log(3);
  log.writeTo(folder / "events.jsonl", kFirstStamp);
  for (int i = 0; i < 10; ++i) log.add(kFirstStamp, "often", "again", {{"i", i}});
  log.close();
  const std::string text = readText(folder / "events.jsonl");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_EQ(text.find("events_not_written"), std::string::npos);
}

TEST(EventLog, WhoListensIsToldEachEvent) {
  EventLog log(1);
  std::vector<std::pair<std::optional<Stamp>, nlohmann::ordered_json>> told;
  log.tell([&](std::optional<Stamp> stamp, const nlohmann::ordered_json& content) {
    told.emplace_back(stamp, content);
  });
  log.add(kFirstStamp, "often", "one", {{"i", 1}});
  log.warn(std::nullopt, "often", "two");
  ASSERT_EQ(told.size(), 2U) << "also what is counted alone";
  EXPECT_EQ(told[0].first, kFirstStamp);
  EXPECT_EQ(told[0].second.dump(),
            R"({"kind":"often","severity":"info","message":"one","fields":{"i":1}})");
  EXPECT_FALSE(told[1].first);
  EXPECT_EQ(told[1].second.at("severity"), "warning");
}

TEST(EventLog, AFullDiskIsAnError) {
  EventLog log;
  log.add(kFirstStamp, "x", "m");
  try {
    log.writeTo("/dev/full", kFirstStamp);
    log.close();
    FAIL() << "a full disk was not noticed";
  } catch (const OutputError& e) {
    EXPECT_EQ(e.code(), ExitCode::kIoError);
  }
}

}  // namespace
}  // namespace perception
