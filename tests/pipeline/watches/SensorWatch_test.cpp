#include "libperception/pipeline/watches/SensorWatch.h"
#include "tests/support/StartStamp.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

using test::kStart;

PipelineSetup::Sensor watchedSensor(const char* label, Modality modality, bool active = true) {
  PipelineSetup::Sensor s;
  s.label = label;
  s.params.modality = modality;
  s.active = active;
  return s;
}

enum WatchPlace : std::size_t { kLidarWatch, kCameraWatch, kUnusedWatch };

/// A watch on a lidar, a camera and a radar that is not in use; timeout 1 s.
struct SensorsWatched {
  std::vector<PipelineSetup::Sensor> sensors = {watchedSensor("LIDAR", Modality::kLidar),
                                                watchedSensor("CAMERA", Modality::kCamera),
                                                watchedSensor("RADAR", Modality::kRadar, false)};
  EventLog events;
  SensorWatch watch{sensors, 1.0, events};

  void see(std::size_t place, double t) { watch.setSeen(place, kStart + t); }
  void check(double t) { watch.check(kStart + t); }
  std::size_t count(const char* kind) const {
    const auto found = events.counts().find(kind);
    return found == events.counts().end() ? 0 : found->second;
  }
  std::string text() const { return events.text(kStart); }
};

TEST(SensorWatch, RecordsAreOfTheSensorsInUseInTheirOrder) {
  const auto records = SensorsWatched().watch.records();
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].label, "LIDAR");
  EXPECT_EQ(records[0].modality, "L");
  EXPECT_EQ(records[1].label, "CAMERA");
  EXPECT_EQ(records[1].modality, "C");
  EXPECT_EQ(records[0].frames, 0U);
}

TEST(SensorWatch, WithoutSensorsNothingIsReported) {
  const std::vector<PipelineSetup::Sensor> none;
  EventLog events;
  SensorWatch watch(none, 1.0, events);
  watch.check(kStart);
  watch.restart(kStart);
  watch.finish();
  EXPECT_TRUE(watch.records().empty());
  EXPECT_TRUE(events.counts().empty());
}

TEST(SensorWatch, AddsUpWhatTheScansHeld) {
  SensorsWatched w;
  MeasurementScan scan;
  scan.measurements.resize(3);
  scan.dropped = 2;
  w.watch.addFrame(kCameraWatch, kStart, &scan);
  w.watch.addFrame(kCameraWatch, kStart + 0.1, &scan);
  const SensorRecord camera = w.watch.records()[kCameraWatch];
  EXPECT_EQ(camera.frames, 2U);
  EXPECT_EQ(camera.measurements, 6U);
  EXPECT_EQ(camera.dropped_measurements, 4U);
  EXPECT_EQ(w.watch.records()[kLidarWatch].frames, 0U);
  EXPECT_TRUE(w.events.counts().empty());
}

TEST(SensorWatch, AFrameForTheGroundAloneCountsAsAFrame) {
  SensorsWatched w;
  w.watch.addFrame(kLidarWatch, kStart, nullptr);
  w.watch.finish();
  EXPECT_EQ(w.watch.records()[kLidarWatch].frames, 1U);
  EXPECT_EQ(w.watch.records()[kLidarWatch].measurements, 0U);
  EXPECT_EQ(w.text().find("LIDAR"), std::string::npos) << w.text();
}

TEST(SensorWatch, DroppedReturnsAreCountedAndReportedOnceASensor) {
  SensorsWatched w;
  MeasurementScan scan;
  scan.dropped_points = 10;
  for (int k = 0; k < 3; ++k) w.watch.addFrame(kLidarWatch, kStart + 0.1 * k, &scan);
  w.watch.countDroppedPoints(kLidarWatch, 5);
  EXPECT_EQ(w.watch.records()[kLidarWatch].dropped_points, 35U);
  EXPECT_EQ(w.count(event_kind::kDroppedPoints), 1U);
  w.watch.addFrame(kCameraWatch, kStart, &scan);
  EXPECT_EQ(w.count(event_kind::kDroppedPoints), 2U);
}

TEST(SensorWatch, DroppedFramesAreCountedAndWarnedOfWhereAsked) {
  SensorsWatched w;
  w.watch.addDroppedFrame(kLidarWatch, kStart, event_kind::kDroppedFrame, "twice", false);
  EXPECT_EQ(w.events.warnings(), 0U);
  w.watch.addDroppedFrame(kLidarWatch, std::nullopt, event_kind::kDroppedFrame, "no stamp", true);
  EXPECT_EQ(w.events.warnings(), 1U);
  EXPECT_EQ(w.count(event_kind::kDroppedFrame), 2U);
  EXPECT_EQ(w.watch.records()[kLidarWatch].dropped_frames, 2U);
  EXPECT_NE(w.text().find("LIDAR: no stamp"), std::string::npos) << w.text();
}

TEST(SensorWatch, SilenceOfMoreThanTheTimeoutIsALoss) {
  SensorsWatched w;
  w.see(kLidarWatch, 0);
  w.check(1.0);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 0U);
  w.check(1.001);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 1U);
  EXPECT_EQ(w.events.warnings(), 1U);
  EXPECT_NE(w.text().find("LIDAR: nothing for 1.001 s"), std::string::npos) << w.text();
}

TEST(SensorWatch, ALossIsReportedOnceUntilTheSensorIsBack) {
  SensorsWatched w;
  w.see(kLidarWatch, 0);
  for (const double t : {2.0, 3.0, 4.0}) w.check(t);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 1U);
  w.see(kLidarWatch, 5);
  w.see(kLidarWatch, 5.1);
  EXPECT_EQ(w.count(event_kind::kSensorBack), 1U);
  w.check(7);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 2U);
}

TEST(SensorWatch, EverySensorHasItsOwnSilence) {
  SensorsWatched w;
  w.see(kLidarWatch, 0);
  for (int k = 0; k <= 30; ++k) {
    w.see(kCameraWatch, 0.1 * k);
    w.check(0.1 * k);
  }
  EXPECT_EQ(w.count(event_kind::kSensorLost), 1U);
  EXPECT_EQ(w.text().find("CAMERA"), std::string::npos) << w.text();
}

TEST(SensorWatch, AnInstantBeforeTheLastIsNoSilence) {
  SensorsWatched w;
  w.see(kLidarWatch, 3);
  w.check(1);
  EXPECT_TRUE(w.events.counts().empty());
}

TEST(SensorWatch, ASensorThatNeverComesIsMissingAndNotLost) {
  SensorsWatched w;
  w.watch.addFrame(kLidarWatch, kStart, nullptr);
  w.see(kLidarWatch, 0);
  w.see(kLidarWatch, 100);
  w.check(100);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 0U);
  w.watch.finish();
  EXPECT_EQ(w.count(event_kind::kSensorMissing), 1U) << w.text();
  EXPECT_NE(w.text().find("CAMERA: in use by the configuration, but nothing of it"),
            std::string::npos);
}

TEST(SensorWatch, ASensorWhoseFramesWereAllDroppedWasInTheLog) {
  SensorsWatched w;
  w.watch.addFrame(kLidarWatch, kStart, nullptr);
  w.watch.addDroppedFrame(kCameraWatch, kStart, event_kind::kDroppedFrame, "damaged", true);
  w.watch.finish();
  EXPECT_EQ(w.count(event_kind::kSensorMissing), 1U);
  EXPECT_EQ(w.text().find("nothing of it in the log"), std::string::npos) << w.text();
}

TEST(SensorWatch, LabelsOfNoSensorAreCountedForTheEnd) {
  SensorsWatched w;
  for (int k = 0; k < 7; ++k) w.watch.countIgnored("SONAR");
  w.watch.countIgnored("");
  EXPECT_EQ(w.count(event_kind::kSensorIgnored), 0U);
  w.watch.finish();
  EXPECT_EQ(w.count(event_kind::kSensorIgnored), 2U);
  EXPECT_NE(w.text().find("\"fields\":{\"frames\":7}"), std::string::npos) << w.text();
}

TEST(SensorWatch, AClockThatWentBackIsNoSilence) {
  SensorsWatched w;
  w.see(kLidarWatch, 1000);
  w.watch.restart(kStart);
  w.check(0.9);
  EXPECT_TRUE(w.events.counts().empty());
}

TEST(SensorWatch, WhoIsSilentAfterAJumpOfTheClockIsLost) {
  SensorsWatched w;
  w.see(kLidarWatch, 1000);
  w.see(kCameraWatch, 1000);
  w.watch.restart(kStart);
  w.see(kCameraWatch, 1.5);
  w.check(1.5);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 1U);
  EXPECT_NE(w.text().find("LIDAR: nothing for 1.500 s"), std::string::npos) << w.text();
}

TEST(SensorWatch, WhoWasLostBeforeAJumpOfTheClockComesBackAfterIt) {
  SensorsWatched w;
  w.see(kLidarWatch, 0);
  w.check(10);
  w.watch.restart(kStart + 1.0);
  w.check(8);
  EXPECT_EQ(w.count(event_kind::kSensorLost), 1U);
  w.see(kLidarWatch, 8.1);
  EXPECT_EQ(w.count(event_kind::kSensorBack), 1U);
}

}  // namespace
}  // namespace perception
