#include "gui-offscreen/html/ReportTimeline.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

nlohmann::json eventAt(double t, const char* kind, const char* sensor = "LIDAR") {
  return {{"t", t}, {"kind", kind}, {"message", "5 < 6 a scan"}, {"fields", {{"sensor", sensor}}}};
}

TEST(ReportTimeline, PhantomsLastFromTheirBeginToTheirEndOrThatOfTheRun) {
  const nlohmann::json events = {eventAt(2, "phantoms_begin"), eventAt(3, "weather"),
                                 eventAt(5, "phantoms_end"), eventAt(8, "phantoms_begin")};
  const TimelineNote note = phantomNote(events, 10);
  ASSERT_EQ(note.stretches.size(), 2U);
  EXPECT_EQ(note.stretches[0].from, 2);
  EXPECT_EQ(note.stretches[0].to, 5);
  EXPECT_EQ(note.stretches[1].from, 8);
  EXPECT_EQ(note.stretches[1].to, 10);
}

TEST(ReportTimeline, PhantomsOfEachLidarEndForThemselves) {
  const TimelineNote note =
      phantomNote({eventAt(1, "phantoms_begin", "A"), eventAt(2, "phantoms_begin", "B"),
                   eventAt(3, "phantoms_end", "A")},
                  10);
  ASSERT_EQ(note.stretches.size(), 2U);
  EXPECT_EQ(note.stretches[0].to, 3);
  EXPECT_EQ(note.stretches[1].to, 10);
}

TEST(ReportTimeline, EventsOfOtherKindsOrWithoutATimeGiveNoRow) {
  nlohmann::json without_time = eventAt(1, "phantoms_begin");
  without_time["t"] = nullptr;
  const TimelineNote note =
      phantomNote({without_time, {{"kind", "phantoms_begin"}}, eventAt(1, "weather")}, 10);
  EXPECT_TRUE(note.stretches.empty());
  EXPECT_TRUE(phantomNote(nullptr, 10).stretches.empty());
  EXPECT_EQ(timelineChart({}, {}, 10, note), timelineChart({}, {}, 10));
}

TEST(ReportTimeline, TheRowOfPhantomsIsAboveThoseOfObjects) {
  const TimelineNote note = phantomNote(nlohmann::json::array({eventAt(2, "phantoms_begin")}), 10);
  const std::string chart = timelineChart({}, {}, 10, note);
  EXPECT_NE(chart.find(">phantoms</text>"), std::string::npos);
  EXPECT_NE(chart.find("5 &lt; 6 a scan, 2.0 to 10.0 s"), std::string::npos) << "escaped";
}

}  // namespace
}  // namespace perception
