#include "libperception/sensors/satellites/GnssFix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "libperception/sensors/ego/EgoFusion.h"
#include "libperception/sensors/ego/EgoReadings.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;
namespace gnss = mrpt::obs::gnss;

mrpt::obs::CObservationGPS observation() {
  mrpt::obs::CObservationGPS o;
  o.timestamp = fromStamp(kStart);
  o.sensorPose = mrpt::poses::CPose3D(1, 0.5, 1.8, 0, 0, 0);
  return o;
}

gnss::Message_NMEA_GGA gga(int quality, float hdop) {
  gnss::Message_NMEA_GGA m;
  m.fields.latitude_degrees = 36.7, m.fields.longitude_degrees = -4.47;
  m.fields.altitude_meters = 48, m.fields.geoidal_distance = 44;
  m.fields.fix_quality = static_cast<std::uint8_t>(quality);
  m.fields.thereis_HDOP = true, m.fields.HDOP = hdop;
  return m;
}

TEST(GnssFix, GgaSaysHowSureItIs) {
  const GnssParams params;
  for (const auto& [quality, sigma] :
       {std::pair{1, 3.0}, {2, 1.5}, {4, 0.03}, {5, 0.375}, {6, 12.0}}) {
    auto o = observation();
    o.setMsg(gga(quality, 2));
    const auto fix = gnssFix(o, params);
    ASSERT_TRUE(fix) << quality;
    EXPECT_NEAR(fix->sigma, sigma, 1e-9) << quality;
    EXPECT_EQ(fix->place.height, 92);
    EXPECT_TRUE(fix->antenna.isApprox(Vector3(1, 0.5, 1.8)));
    EXPECT_FALSE(fix->has_velocity);
  }
  for (const int quality : {0, 7}) {
    auto o = observation();
    o.setMsg(gga(quality, 1));
    EXPECT_FALSE(gnssFix(o, params)) << quality;
  }
}

TEST(GnssFix, CourseOfRmcIsVelocityToEastAndNorth) {
  auto o = observation();
  gnss::Message_NMEA_RMC rmc;
  rmc.fields.validity_char = 'A';
  rmc.fields.latitude_degrees = 36.7, rmc.fields.longitude_degrees = -4.47;
  rmc.fields.speed_knots = 10;
  rmc.fields.direction_degrees = 30;
  o.setMsg(rmc);
  auto fix = gnssFix(o, {});
  ASSERT_TRUE(fix);
  EXPECT_FALSE(fix->has_height);
  ASSERT_TRUE(fix->has_velocity);
  const double speed = 10 * 1852. / 3600;
  EXPECT_NEAR(fix->velocity.x(), speed * 0.5, 1e-9);
  EXPECT_NEAR(fix->velocity.y(), speed * std::sqrt(0.75), 1e-9);
  o.setMsg(gga(1, 1));
  fix = gnssFix(o, {});
  ASSERT_TRUE(fix);
  EXPECT_TRUE(fix->has_height && fix->has_velocity);
  rmc.fields.validity_char = 'V';
  mrpt::obs::CObservationGPS invalid = observation();
  invalid.setMsg(rmc);
  EXPECT_FALSE(gnssFix(invalid, {}));
}

TEST(GnssFix, NovatelGivesItsOwnDeviationsAndHeading) {
  auto o = observation();
  gnss::Message_NV_OEM6_BESTPOS best;
  best.fields.solution_stat = gnss::nv_oem6_solution_status::SOL_COMPUTED;
  best.fields.lat = 42, best.fields.lon = -76, best.fields.hgt = 200, best.fields.undulation = -30;
  best.fields.lat_sigma = 0.3F, best.fields.lon_sigma = 0.4F, best.fields.hgt_sigma = 0.9F;
  o.setMsg(best);
  auto fix = gnssFix(o, {});
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->sigma, 0.5 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(fix->height_sigma, 0.9, 1e-6);
  EXPECT_NEAR(fix->place.height, 170, 1e-9);
  gnss::Message_NV_OEM6_INSPVAS ins;
  ins.fields.ins_status = gnss::nv_oem6_ins_status_type::INS_SOLUTION_GOOD;
  ins.fields.lat = 42, ins.fields.lon = -76, ins.fields.hgt = 170;
  ins.fields.vel_east = 3, ins.fields.vel_north = 4;
  ins.fields.azimuth = 60;
  o.setMsg(ins);
  fix = gnssFix(o, {});
  ASSERT_TRUE(fix && fix->yaw && fix->has_velocity);
  EXPECT_NEAR(*fix->yaw, radians(30), 1e-12);
  EXPECT_NEAR(fix->velocity.norm(), 5, 1e-12);
}

TEST(GnssFix, CartesianPositionsAreTheSamePlace) {
  const LocalFrame frame({36.7, -4.47, 92});
  gnss::Message_TOPCON_PZS pzs;
  pzs.hasCartesianPosVel = true;
  // WGS84 by its formula: N = a / sqrt(1 - e^2 sin^2 lat).
  const double a = 6378137, e2 = 6.69437999014e-3, la = radians(36.7), lo = radians(-4.47);
  const double n = a / std::sqrt(1 - e2 * std::sin(la) * std::sin(la));
  pzs.cartesian_x = (n + 92) * std::cos(la) * std::cos(lo);
  pzs.cartesian_y = (n + 92) * std::cos(la) * std::sin(lo);
  pzs.cartesian_z = (n * (1 - e2) + 92) * std::sin(la);
  // Five meters a second to the north.
  pzs.cartesian_vx = -5 * std::sin(la) * std::cos(lo);
  pzs.cartesian_vy = -5 * std::sin(la) * std::sin(lo);
  pzs.cartesian_vz = 5 * std::cos(la);
  auto o = observation();
  o.setMsg(pzs);
  const auto fix = gnssFix(o, {});
  ASSERT_TRUE(fix);
  EXPECT_LT(frame.fromGeodetic(fix->place).norm(), 1e-3);
  ASSERT_TRUE(fix->has_velocity);
  EXPECT_NEAR(fix->velocity.x(), 0, 1e-9);
  EXPECT_NEAR(fix->velocity.y(), 5, 1e-9);
}

TEST(GnssFix, NonsenseIsNoFix) {
  auto nowhere = observation();
  auto m = gga(1, 1);
  m.fields.latitude_degrees = m.fields.longitude_degrees = 0;
  nowhere.setMsg(m);
  EXPECT_FALSE(gnssFix(nowhere, {}));
  m.fields.latitude_degrees = std::numeric_limits<double>::quiet_NaN();
  nowhere.setMsg(m);
  EXPECT_FALSE(gnssFix(nowhere, {}));
  auto timeless = observation();
  timeless.setMsg(gga(1, 1));
  timeless.timestamp = INVALID_TIMESTAMP;
  EXPECT_FALSE(gnssFix(timeless, {}));
  EXPECT_FALSE(gnssFix(observation(), {}));
}

TEST(LocalFrame, GoesThereAndBack) {
  const LocalFrame frame({42.444, -76.5019, 250});
  for (const Vector3& p : {Vector3(0, 0, 0), Vector3(1500, -700, 12), Vector3(-3, 4000, -20)}) {
    EXPECT_LT((frame.fromGeodetic(frame.toGeodetic(p)) - p).norm(), 1e-4);
  }
  EXPECT_GT(frame.fromGeodetic({42.445, -76.5019, 250}).y(), 110);
}

TEST(EgoReadings, InertialUnitIsTurnedIntoTheVehicle) {
  mrpt::obs::CObservationIMU imu;
  imu.sensorPose = mrpt::poses::CPose3D(2, 0, 0, kPi / 2, 0, 0);  // its x axis is our y axis
  imu.set(mrpt::obs::IMU_WX, 0.1);
  imu.set(mrpt::obs::IMU_WY, 0);
  imu.set(mrpt::obs::IMU_WZ, 0.5);
  imu.set(mrpt::obs::IMU_X_ACC, 3);
  imu.set(mrpt::obs::IMU_Y_ACC, 0);
  imu.set(mrpt::obs::IMU_Z_ACC, 9.8);
  const auto reading = imuReading(imu);
  ASSERT_TRUE(reading && reading->gyro && reading->accelerometer);
  EXPECT_TRUE(reading->rates.isApprox(Vector3(0, 0.1, 0.5), 1e-9));
  // Two meters ahead the turning is felt as -w^2 r along x: taken off.
  EXPECT_NEAR(reading->force.x(), 2 * (0.5 * 0.5 + 0.1 * 0.1), 1e-9);
  EXPECT_NEAR(reading->force.y(), 3, 1e-9);
  imu.set(mrpt::obs::IMU_WZ, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(imuReading(imu));
  EXPECT_FALSE(imuReading(mrpt::obs::CObservationIMU()));
}

TEST(EgoReadings, SumsOfAnOdometerBecomeSpeeds) {
  Odometers odometers;
  mrpt::obs::CObservationOdometry o;
  o.sensorLabel = "ODOMETRY";
  EXPECT_FALSE(odometers.read(o, kStart));
  o.odometry = mrpt::poses::CPose2D(0.5, 0, 0.1);
  const auto reading = odometers.read(o, kStart + 0.1);
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->speed, 5, 1e-9);
  EXPECT_NEAR(*reading->yaw_rate, 1, 1e-9);
  EXPECT_FALSE(odometers.read(o, kStart + 0.05));
  EXPECT_FALSE(odometers.read(o, kStart + 5.0));
  o.hasVelocities = true;
  o.velocityLocal.vx = -2;
  EXPECT_EQ(odometers.read(o, kStart + 0.2)->speed, -2);
}

// MRPT's sample: RTK antennas on a car. The heading comes from the two at its front at one instant
// (the clock of the third, at the rear, is seconds off).
TEST(EgoFusion, RealRtkAntennasAgreeOnOneVehicle) {
  const std::string file =
      std::string(PERCEPTION_SHARED_DATA) + "/data/mrpt_samples/test_rtk_path.rawlog";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  RawlogReader reader(file);
  EgoFusion fusion({});
  std::size_t fixes = 0;
  while (const auto o = reader.next()) {
    if (o->sensorLabel != "GPS_RTK_REAR") fixes += fusion.add(*o);
  }
  EXPECT_GT(fixes, 400U);
  const EgoMotionState& s = fusion.state();
  EXPECT_TRUE(s.heading_known);
  EXPECT_EQ(s.relocations, 1U);
  EXPECT_LT(s.rejected_fixes, s.fixes / 20);
  EXPECT_LT(std::sqrt(s.estimate.P(kEgoYaw, kEgoYaw)), radians(3));
  EXPECT_LT(std::sqrt(s.estimate.P(kEgoX, kEgoX)), 0.2);
}

}  // namespace
}  // namespace perception
