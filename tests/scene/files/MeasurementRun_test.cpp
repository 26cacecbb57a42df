#include "libperception/scene/files/MeasurementRun.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/measurement/models/PositionModel.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

ClassTable twoClasses() {
  ClassTable classes;
  for (const char* name : {"pedestrian", "car"}) {
    classes.classes.emplace_back();
    classes.classes.back().name = name;
  }
  return classes;
}

// Sees both classes up to 20 m.
MeasurementScan makeScan() {
  PositionModel::Params params;
  params.classes.resize(2);
  params.range = 20;
  MeasurementScan scan;
  scan.sensor = "BOXES";
  scan.modality = Modality::kCamera;
  scan.frame = 7;
  scan.state.stamp = Stamp::fromSeconds(1000.5);
  scan.state.T_world_sensor = makePose(1, 2, 1.5, kPi / 2);
  scan.state.ego.T_world_ego = makePose(0, 2, 0, kPi / 2);
  scan.model = std::make_shared<PositionModel>(params);
  Measurement m;
  m.z = Vector2(1, 12);
  m.R = Matrix2::Identity();
  m.seen = 3;
  m.label = 1;
  m.position = {1, 12};
  m.position_sigma = 0.5;
  scan.measurements.push_back(m);
  return scan;
}

TEST(DescribeSensor, ProbesHowFarAClassIsSeen) {
  const RecordedSensor sensor = describeSensor(makeScan(), {"person", "car"}, kTwoPi, 0, 70, 2);
  ASSERT_EQ(sensor.class_range.size(), 2u);
  EXPECT_NEAR(sensor.class_range[0], 20, 0.5);
}

TEST(RecordScan, PutsMeasurementsIntoTheSensorsPolarCoordinates) {
  const MeasurementScan scan = makeScan();
  const RecordedSensor sensor = describeSensor(scan, {"person", "car"}, kTwoPi, 0, 70, 2);
  const RecordedScan recorded = recordScan(scan, sensor);
  ASSERT_EQ(recorded.measurements.size(), 1u);
  EXPECT_EQ(recorded.measurements[0].label, "car");
  EXPECT_NEAR(recorded.measurements[0].range, 10, 1e-9);
  EXPECT_NEAR(recorded.measurements[0].bearing, 0, 1e-9);
  EXPECT_DOUBLE_EQ(recorded.measurements[0].sd_range, 0.5);
}

TEST(RecordScan, DropsWhatIsNotFinite) {
  MeasurementScan scan = makeScan();
  scan.measurements[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  const RecordedScan recorded = recordScan(scan, {});
  EXPECT_TRUE(recorded.measurements.empty());
  EXPECT_EQ(recorded.dropped, 1u);
}

class MeasurementFiles : public testing::Test {
 protected:
  void SetUp() override {
    const Stamp start = Stamp::fromSeconds(1000);
    MeasurementRunWriter writer(folder_.path(), twoClasses());
    MeasurementScan scan = makeScan();
    const RecordedSensor sensor = describeSensor(scan, {"person", "car"}, kPi, 0, 70, 2);
    writer.writeSensor(sensor);
    writer.write(recordScan(scan, sensor), sensor, start);
    scan.measurements.clear();
    scan.state.stamp = Stamp::fromSeconds(1000.6);
    writer.write(recordScan(scan, sensor), sensor, start);
    writer.close();
  }
  std::string file(const std::string& name) const { return folder_.path() + "/" + name; }

  test::TemporaryFolder folder_;
};

TEST_F(MeasurementFiles, AreReadAsTheyWereWritten) {
  const MeasurementRun run = readMeasurementRun(folder_.path());
  EXPECT_EQ(run.first_stamp.ns, Stamp::fromSeconds(1000).ns);
  EXPECT_EQ(run.class_names, (std::vector<std::string>{"pedestrian", "car"}));
  ASSERT_EQ(run.sensors.size(), 1u);
  EXPECT_EQ(run.sensors[0].labels, (std::vector<std::string>{"person", "car"}));
  EXPECT_EQ(run.sensors[0].modality, Modality::kCamera);
  EXPECT_NEAR(run.sensors[0].fov, kPi, 1e-6);
  ASSERT_EQ(run.scans.size(), 2u);
  EXPECT_EQ(run.scans[0].frame, 7);
  EXPECT_NEAR(yawOf(run.scans[0].T_world_sensor), kPi / 2, 1e-6);
  ASSERT_EQ(run.scans[0].measurements.size(), 1u);
  EXPECT_EQ(run.scans[0].measurements[0].label, "car");
  EXPECT_TRUE(std::isnan(run.scans[0].measurements[0].length));
  EXPECT_TRUE(run.scans[1].measurements.empty());
}

TEST_F(MeasurementFiles, ThatWereCutAreFound) {
  std::ofstream(file("measurements.csv"))
      << "sensor,frame,t,stamp,label,x,y,range,bearing,sd_range,sd_across,score,length,width,"
         "height\n";
  EXPECT_THROW(readMeasurementRun(folder_.path()), DataError);
}

TEST_F(MeasurementFiles, ThatWereNeverWrittenAreNoInput) {
  try {
    readMeasurementRun(folder_.path() + "/nowhere");
    FAIL();
  } catch (const DataError& error) {
    EXPECT_EQ(error.code(), ExitCode::kNoInput);
  }
}

}  // namespace
}  // namespace perception
