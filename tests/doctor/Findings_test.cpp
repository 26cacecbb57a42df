#include "libperception/doctor/Findings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

/// A scan with times that begin at `offset` [s] after its stamp.
SensorFrame scanAt(const std::string& sensor, double t, double offset = 0) {
  SensorFrame frame;
  frame.sensor = sensor;
  frame.stamp = Stamp{1'700'000'000'000'000'000} + t;
  LidarCloud cloud;
  for (int i = 0; i < 90; ++i) {
    cloud.x.push_back(static_cast<float>(10 * std::cos(0.07 * i)));
    cloud.y.push_back(static_cast<float>(10 * std::sin(0.07 * i)));
    cloud.z.push_back(0.5F);
    cloud.intensity.push_back(0.5F);
    cloud.time_offset.push_back(static_cast<float>(offset + 0.001 * i));
  }
  frame.data = cloud;
  return frame;
}

/// The faults and notes of a log, a line each.
std::string toldOf(const std::vector<SensorFrame>& frames) {
  registerPerceptionClasses();
  LogSurvey survey;
  for (const SensorFrame& frame : frames) survey.look(*observationFromFrame(frame));
  std::string told;
  for (const Finding& finding : findingsOf(survey))
    if (finding.weight != Finding::Weight::kFine)
      told += (finding.weight == Finding::Weight::kFault ? "FAULT " : "note ") + finding.about +
              ": " + finding.text + "\n";
  return told;
}

void expectTold(const std::string& told, const std::string& text) {
  EXPECT_NE(told.find(text), std::string::npos) << "'" << text << "' is not in\n" << told;
}

TEST(Findings, ATimeThatGoesBackIsAFaultAndOneLateScanANote) {
  std::vector<SensorFrame> jump, late;
  for (const double t : {0.0, 0.1, 0.2, 5.0, 0.3, 0.4}) jump.push_back(scanAt("L", t));
  expectTold(toldOf(jump),
             "FAULT L: time goes back: 2 of 6 frames are older than one before, by "
             "up to 4.700 s");
  for (const double t : {0.0, 0.2, 0.1, 0.3}) late.push_back(scanAt("L", t));
  expectTold(toldOf(late), "note L: time goes back: 1 of 4 frames");
  EXPECT_EQ(toldOf({scanAt("L", 0), scanAt("L", 0.1)}).find("goes back"), std::string::npos);
}

TEST(Findings, ReturnsSecondsOutsideOfTheirScanAreAFault) {
  expectTold(toldOf({scanAt("L", 0), scanAt("L", 0.1, 5), scanAt("L", 0.2, -3)}),
             "FAULT L: returns lie more than 1.05 s outside of 2 of 3 scans");
  EXPECT_EQ(toldOf({scanAt("L", 0, -0.05)}).find("outside"), std::string::npos);
}

TEST(Findings, PlacesThatStandForNoReturnAreAFault) {
  SensorFrame frame = scanAt("L", 0);
  auto& cloud = std::get<LidarCloud>(frame.data);
  for (int i = 0; i < 30; ++i) cloud.x[static_cast<std::size_t>(3 * i)] = 1e6F;
  expectTold(toldOf({frame, scanAt("L", 0.1)}),
             "FAULT L: 30 points are no returns: they lie farther than 1000 m");
  EXPECT_EQ(toldOf({scanAt("L", 0)}).find("no returns"), std::string::npos);
}

TEST(Findings, ASensorOfAnotherTimeThanAllOthersIsAFault) {
  std::vector<SensorFrame> frames;
  for (const double t : {0.0, 0.1, 0.2}) {
    frames.push_back(scanAt("A", t));
    frames.push_back(scanAt("B", t + 0.02));
    frames.push_back(scanAt("C", t + 3600));
  }
  const std::string told = toldOf(frames);
  expectTold(told, "FAULT C: its stamps lie 3599.780 s apart from those of everything else");
  EXPECT_EQ(told.find("FAULT A"), std::string::npos) << told;
}

}  // namespace
}  // namespace perception
