#include "libperception/radar/RadarFrontEnd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace perception {
namespace {

const char* const kIni = R"(
[class.car]
motion = wheeled
[class.pedestrian]
motion = constant-velocity
[sensor.RADAR]
kind = radar
modality = R
fov_deg = 360
[sensor.RADAR.radar]
)";

std::unique_ptr<FrontEnd> frontEnd(const std::string& keys = "") {
  Config config = Config::fromText(kIni + keys, "radar.ini");
  const ClassTable classes = readClassTable(config);
  auto front_end = makeRadarFrontEnd(config, "RADAR", classes);
  config.finish();
  return front_end;
}

RadarReturn target(double range, double bearing, double rate, double amplitude = 10) {
  RadarReturn r;
  r.range = range, r.bearing = bearing, r.range_rate = rate, r.amplitude = amplitude;
  return r;
}

SensorFrame frameOf(std::vector<RadarReturn> returns) {
  SensorFrame frame;
  frame.sensor = "RADAR";
  frame.ego.uncertainty = {0, 0, 0};
  frame.data = RadarReturns{std::move(returns), 0};
  return frame;
}

TEST(RadarFrontEnd, HandsReturnsOverInTheFrameOfTheUnit) {
  SensorFrame frame = frameOf({target(30, 0.2, -5)});
  frame.ego.T_world_ego = makePose(100, 50, 0, 1.0);
  frame.T_ego_sensor = makePose(3.5, 0.5, 0.6, 0.4);
  const auto scan = frontEnd()->extract(frame);
  ASSERT_EQ(scan.measurements.size(), 1u);
  const Measurement& m = scan.measurements[0];
  EXPECT_EQ(m.seen, RadarModel::kAll);
  EXPECT_NEAR(m.z[RadarModel::kRange], 30, 1e-12);
  EXPECT_NEAR(m.z[RadarModel::kBearing], 0.2, 1e-12);
  EXPECT_NEAR(m.z[RadarModel::kRate], -5, 1e-12);
  const Vector3 there = frame.T_world_sensor() * Vector3(30 * std::cos(0.2), 30 * std::sin(0.2), 0);
  EXPECT_NEAR((m.position - there.head<2>()).norm(), 0, 1e-9);
  EXPECT_EQ(scan.modality, Modality::kRadar);
}

TEST(RadarFrontEnd, AUnitOnItsHeadSeesLeftAndRightExchanged) {
  const auto bearing = [](const std::string& keys, double roll) {
    SensorFrame frame = frameOf({target(30, 0.2, -5)});
    frame.T_ego_sensor = makePose(3.5, 0.5, 0.6, 0.4, 0, roll);
    return frontEnd(keys)->extract(frame).measurements.at(0).z[RadarModel::kBearing];
  };
  EXPECT_NEAR(bearing("", 0), 0.2, 1e-12);
  EXPECT_NEAR(bearing("upside_down = true\n", 0), -0.2, 1e-12);
  EXPECT_NEAR(bearing("", kPi), -0.2, 1e-12);  // the log's pose says it
}

TEST(RadarFrontEnd, ReturnsWithoutARateUseTwoAxes) {
  RadarReturn r = target(30, 0.2, 0);
  r.has_rate = false;
  const auto scan = frontEnd()->extract(frameOf({r}));
  ASSERT_EQ(scan.measurements.size(), 1u);
  EXPECT_EQ(scan.measurements[0].seen, RadarModel::kNoRate);
  EXPECT_EQ(scan.measurements[0].R(2, 2), 0);
  EXPECT_EQ(residual(*scan.model, scan.measurements[0], scan.measurements[0].z).size(), 2);
}

TEST(RadarFrontEnd, ARisingLineOfSightIsProjectedToTheGround) {
  RadarReturn r = target(20, 0, -6);
  r.elevation = radians(30);
  const auto scan = frontEnd()->extract(frameOf({r}));
  EXPECT_NEAR(scan.measurements.at(0).z[RadarModel::kRange], 20 * std::cos(radians(30)), 1e-9);
  EXPECT_NEAR(scan.measurements.at(0).z[RadarModel::kRate], -6 / std::cos(radians(30)), 1e-9);
}

TEST(RadarFrontEnd, ReturnsOfOneObjectAreOneMeasurement) {
  // The first three; another speed or 4 m farther is another object.
  const auto scan = frontEnd()->extract(frameOf(
      {target(30.0, 0.00, -5.0, 8), target(30.4, 0.03, -5.2, 14), target(30.9, 0.06, -5.1, 9),
       target(30.2, 0.02, 3.0, 7), target(34, 0.01, -5.0, 6)}));
  ASSERT_EQ(scan.measurements.size(), 3u);
  const Measurement& merged = scan.measurements[0];
  EXPECT_NEAR(merged.z[RadarModel::kRange], 30.4333, 1e-3);
  EXPECT_NEAR(merged.z[RadarModel::kBearing], 0.03, 1e-12);
  EXPECT_EQ(merged.detection, 1);  // the strongest
  EXPECT_GT(merged.R(1, 1), scan.measurements[1].R(1, 1));
}

TEST(RadarFrontEnd, CarsAbreastStayApart) {
  std::vector<RadarReturn> row;  // 3.5 m from lane to lane, 25 m ahead
  for (const double y : {-7.0, -3.5, 0.0, 3.5}) row.push_back(target(25, std::asin(y / 25), -5));
  EXPECT_EQ(frontEnd()->extract(frameOf(row)).measurements.size(), 4u);
}

TEST(RadarFrontEnd, ReturnsOnBothSidesOfTheRearAreOneObject) {
  const auto scan =
      frontEnd()->extract(frameOf({target(10, kPi - 0.02, -5), target(10, -kPi + 0.02, -5)}));
  ASSERT_EQ(scan.measurements.size(), 1u);
  EXPECT_NEAR(std::abs(scan.measurements[0].z[RadarModel::kBearing]), kPi, 1e-9);
}

TEST(RadarFrontEnd, DropsTheEchoThatWentToAndFroTwice) {
  const auto moving = frameOf({target(12, 0.1, -4, 20), target(24.2, 0.1, -8.1, 5)});
  const auto scan = frontEnd()->extract(moving);
  EXPECT_EQ(scan.measurements.size(), 1u);
  EXPECT_EQ(scan.dropped, 1u);
  EXPECT_EQ(frontEnd("drop_double_bounce = false\n")->extract(moving).measurements.size(), 2u);
  // A second object at twice the range with the same rate is one; so is what stands behind.
  EXPECT_EQ(frontEnd()
                ->extract(frameOf({target(12, 0.1, -4, 20), target(24, 0.1, -4, 5)}))
                .measurements.size(),
            2u);
  EXPECT_EQ(frontEnd()
                ->extract(frameOf({target(12, 0.1, 0, 20), target(24, 0.1, 0, 5)}))
                .measurements.size(),
            2u);
}

TEST(RadarFrontEnd, DropsAndCountsWhatLiesOutsideTheView) {
  const auto scan = frontEnd()->extract(frameOf({target(119, 0, 0), target(121, 0, 0)}));
  EXPECT_EQ(scan.measurements.size(), 1u);  // range_max is 120 m unless the INI says otherwise
  EXPECT_EQ(scan.dropped, 1u);
}

TEST(RadarFrontEnd, DropsAndCountsWhatIsNoReturn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SensorFrame frame = frameOf({target(nan, 0, 0), target(10, nan, 0), target(-1, 0, 0),
                               target(10, 0, nan), target(300, 0, 0), target(20, 0, -3)});
  std::get<RadarReturns>(frame.data).max_range = 200;
  const auto scan = frontEnd()->extract(frame);
  EXPECT_EQ(scan.measurements.size(), 1u);
  EXPECT_EQ(scan.dropped, 5u);
}

TEST(RadarFrontEnd, PoseNoiseOfTheVehicleIsInR) {
  SensorFrame frame = frameOf({target(30, 0.3, -10)});
  frame.ego.velocity = {14, 0};
  const auto sure = frontEnd()->extract(frame).measurements.at(0).R;
  frame.ego.uncertainty = {0.2, radians(1), 0};
  const auto unsure = frontEnd()->extract(frame).measurements.at(0).R;
  const AxisMatrix more = unsure - sure;
  EXPECT_NEAR(more(0, 0), 0.04, 1e-12);
  EXPECT_NEAR(more(1, 1), std::pow(radians(1), 2) + std::pow(0.2 / 30, 2), 1e-12);
  EXPECT_NEAR(more(2, 2), std::pow(14 * std::sin(0.3) * 0.2 / 30, 2), 1e-12);
  EXPECT_NEAR(more(1, 2), more(2, 1), 1e-15);
}

TEST(RadarFrontEnd, NoiseOfDucsUnitsComesFromTheIni) {
  const auto scan =
      frontEnd("range_sigma = 5\nbearing_sigma_deg = 5\nrate_sigma = 1\nown_speed_sigma = 0\n")
          ->extract(frameOf({target(30, 0, 0)}));
  EXPECT_NEAR(scan.measurements[0].R(0, 0), 25, 1e-12);
  EXPECT_NEAR(scan.measurements[0].R(1, 1), std::pow(radians(5), 2), 1e-12);
  EXPECT_NEAR(scan.measurements[0].R(2, 2), 1, 1e-12);
}

}  // namespace
}  // namespace perception
