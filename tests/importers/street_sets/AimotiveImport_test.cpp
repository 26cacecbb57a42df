#include <gtest/gtest.h>
#include <mrpt/obs/CObservationImage.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "libperception/core/GroundTruth.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/street_sets/AimotiveFiles.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using test::sharedData;

constexpr const char* kRows = "[[1,0,0,%],[0,1,0,0],[0,0,1,1],[0,0,0,1]]";

std::string poseText(const std::string& x) {
  std::string text = kRows;
  return text.replace(text.find('%'), 1, x);
}

/// A vehicle at 10 m/s whose lidar stands above its origin; a turn takes 0.1 s, its middle is the
/// instant of the middle frame.
class AimotiveImport : public test::ImportRun {
 protected:
  void SetUp() override {
    write("a/calib.json",
          R"({"M_LIDAR_M":{"RT_body_from_sensor":)" + poseText("0") +
              R"(},"F_LRR_C":{"RT_body_from_sensor":)" + poseText("4") +
              R"(},"B_LRR_C":{"RT_body_from_sensor":)" +
              "[[-1,0,0,-1],[0,-1,0,0],[0,0,1,0.5],[0,0,0,1]]" +
              R"(},"F_MIDLONGRANGECAM_CL":{"RT_body_from_sensor":)" +
              "[[0,0,1,2],[-1,0,0,0],[0,-1,0,1.2],[0,0,0,1]]" +
              R"(,"focal_length_px":[700,600],"principal_point_px":[30,20],)" +
              R"("distortion_coeffs":[-0.3,0.1,0.01,0.02,0.5],"image_resolution_px":[60,40]}})");
    write("a/frames.csv", "frame,t\n0,0\n1,0.1\n2,0.2\n");
    write("a/ego.csv", "frame,t,vx,vy,yaw_rate\n0,0,10,0,0\n1,0.1,10,0,0\n2,0.2,10,0,0\n");
    write("a/scans.csv", "scan,t_start,t_end,points\n7,0.05,0.15,3\n");
    write("a/boxes.csv", std::string(kHeader) +
                             "0,0,3,CAR,0.2,10,0.75,4,2,1.5,0,-2,0,0,0,0\n"
                             "1,0.1,3,CAR,0,10,0.75,4,2,1.5,0,-2,0,0,0,0\n"
                             "2,0.2,3,CAR,-0.2,10,0.75,4,2,1.5,0,-2,0,0,0,0\n");
    write("a/radar_front.csv", std::string(kRadar) + "1,0.1,20,0.1,0.02,-9.9,5,1,1\n");
    write("a/radar_rear.csv", std::string(kRadar) + "1,0.1,15,-0.1,0,9.9,6,1,1\n");
    // Ahead, to the left (on the car), behind to the right.
    write("a/lidar/000007.bin", bytesOf<float>({20, 0, 0.5F, 1, 0, 10, 0.5F, 1, 0, -10, 0.5F, 1}));
    fs::create_directories(file("a/camera_front"));
    for (const char* name : {"000000", "000001", "000002"})
      cv::imwrite(file(std::string("a/camera_front/") + name + ".jpg"),
                  cv::Mat(40, 60, CV_8UC3, cv::Scalar(9)));
  }
  std::vector<std::string> dir() const { return {"--dir", file("a")}; }

  static constexpr const char* kHeader =
      "frame,t,id,type,x,y,z,length,width,height,yaw,vx_rel,vy_rel,vz_rel,occluded,truncated\n";
  static constexpr const char* kRadar =
      "frame,t,range,azimuth,elevation,range_rate,rcs,power,noise\n";
};

TEST_F(AimotiveImport, PointsCarryTheTimeAtWhichTheTurnPassedThem) {
  ASSERT_EQ(import("aimotive", dir()), 0) << error_;
  const auto frames = framesOf("LIDAR_TOP");
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].ego.T_world_ego.translation().x(), 1, 1e-9);
  EXPECT_NEAR(frames[0].ego.velocity.x(), 10, 1e-6);
  const auto& cloud = std::get<LidarCloud>(frames[0].data);
  ASSERT_EQ(cloud.time_offset.size(), 3u);
  EXPECT_NEAR(cloud.time_offset[0], 0, 1e-7);  // clockwise from behind
  EXPECT_NEAR(cloud.time_offset[1], -0.025, 1e-7);
  EXPECT_NEAR(cloud.time_offset[2], 0.025, 1e-7);
  EXPECT_FLOAT_EQ(cloud.z[0], -0.5F);
  EXPECT_EQ(frameNumbers(), (std::vector<std::int64_t>{7}));
}

TEST_F(AimotiveImport, BoxesStandWhereTheirReturnsWereTaken) {
  ASSERT_EQ(import("aimotive", dir()), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 1u);
  const TruthObject& car = truth.instants[0].objects.at(0);
  EXPECT_EQ(car.id, 3);
  EXPECT_EQ(car.type, "Car");
  EXPECT_NEAR(car.position.x(), 1 + 0.05, 1e-3);  // 0.025 s before the middle, at -2 m/s
  EXPECT_NEAR(car.position.y(), 10, 1e-6);
  EXPECT_NEAR(car.position.z(), 0, 1e-6);
  EXPECT_NEAR(car.vx, 8, 1e-6);  // over ground
  EXPECT_NEAR(car.vy, 0, 1e-6);
  EXPECT_EQ(car.lidar_points, 1);
}

TEST_F(AimotiveImport, RadarsAndCameraStandAtTheirOwnTimes) {
  ASSERT_EQ(import("aimotive", dir()), 0) << error_;
  const auto front = framesOf("RADAR_FRONT"), rear = framesOf("RADAR_REAR");
  ASSERT_EQ(front.size(), 1u);
  ASSERT_EQ(rear.size(), 1u);
  const RadarReturn& r = std::get<RadarReturns>(front[0].data).returns.at(0);
  EXPECT_EQ(r.range, 20);
  EXPECT_EQ(r.bearing, 0.1);
  EXPECT_EQ(r.elevation, 0.02);
  EXPECT_EQ(r.range_rate, -9.9);
  EXPECT_EQ(r.amplitude, 5);
  EXPECT_TRUE(front[0].T_ego_sensor.isApprox(makePose(4, 0, 1, 0), 1e-9));
  EXPECT_NEAR(std::abs(yawOf(rear[0].T_ego_sensor)), kPi, 1e-9);
  int images = 0;
  for (const auto& o : readLog()) {
    const auto image = std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(o);
    if (!image) continue;
    ++images;
    EXPECT_EQ(image->sensorLabel, "CAMERA_FRONT");
    EXPECT_EQ(image->cameraParams.fx(), 700);
    EXPECT_EQ(image->cameraParams.fy(), 600);
    EXPECT_EQ(image->cameraParams.k1(), -0.3);
    EXPECT_EQ(image->cameraParams.p2(), 0.02);
    EXPECT_EQ(image->cameraParams.k3(), 0.5);
  }
  EXPECT_EQ(images, 1);  // the frames within the turn
}

TEST_F(AimotiveImport, MotionIsIntegratedByTrapezoidsAndGoesOnBeyondTheRows) {
  write("a/ego.csv", "t,vx,vy,yaw_rate\n0,10,0,1\n0.1,20,0,1\n");
  const AimotiveEgo ego(file("a/ego.csv"));
  EXPECT_NEAR(yawOf(ego.at(0.1).T_world_body), 0.1, 1e-9);
  EXPECT_NEAR(ego.at(0.1).T_world_body.translation().norm(), 1.5, 1e-3);
  EXPECT_NEAR(ego.at(0.05).velocity.x(), 15, 1e-9);
  EXPECT_NEAR(yawOf(ego.at(0.2).T_world_body), 0.2, 1e-9);
  EXPECT_NEAR(ego.at(-0.1).T_world_body.translation().x(), -1, 1e-2);
  EXPECT_EQ(ego.at(-0.1).velocity.x(), 10);
}

TEST_F(AimotiveImport, ALabelHoldsATenthOfASecondBeyondItsRows) {
  const auto rows = readAimotiveBoxes(file("a/boxes.csv")).at(3);
  ASSERT_TRUE(boxAt(rows, 0.29));
  EXPECT_NEAR(boxAt(rows, 0.29)->box.bottom_center.x(), -0.38, 1e-9);
  EXPECT_NEAR(boxAt(rows, -0.05)->box.bottom_center.x(), 0.3, 1e-9);
  EXPECT_NEAR(boxAt(rows, 0.15)->box.bottom_center.x(), -0.1, 1e-9);
  EXPECT_FALSE(boxAt(rows, 0.31));
  EXPECT_FALSE(boxAt({}, 0));
}

TEST_F(AimotiveImport, FaultsNameFileLineAndColumn) {
  expectFault(66, "nowhere", "aimotive", {"--dir", file("nowhere")});
  expectFault(65, "scans.csv: none of the wanted turns", "aimotive",
              {"--dir", file("a"), "--last", "3"});
  const auto damaged = [&](const std::string& name, const std::string& text,
                           const std::string& message) {
    SetUp();
    write(name, text);
    expectFault(65, message, "aimotive", dir());
  };
  damaged("a/calib.json", "{", "calib.json: no JSON object");
  damaged("a/calib.json", "{}", "calib.json: M_LIDAR_M: no RT_body_from_sensor of 16 numbers");
  damaged("a/calib.json",
          R"({"M_LIDAR_M":{"RT_body_from_sensor":[[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}})",
          "calib.json: M_LIDAR_M: RT_body_from_sensor is no rigid motion");
  damaged("a/scans.csv", "scan,t_start,t_end,points\n7,0.05,0.05,3\n",
          "scans.csv:2: column 't_end': found '0.05', expected a time after t_start");
  damaged("a/ego.csv", "t,vx,vy,yaw_rate\n0.1,1,0,0\n0,1,0,0\n",
          "ego.csv:3: column 't': found '0', expected a time not before");
  damaged("a/ego.csv", "t,vx,vy,yaw_rate\n", "ego.csv: no row in it");
  damaged("a/boxes.csv", std::string(kHeader) + "0,0,3,CAR,0,10,0.75,4,-2,1.5,0,0,0,0,0,0\n",
          "boxes.csv:2: column 'width': found '-2', expected a number above 0");
  damaged("a/boxes.csv",
          std::string(kHeader) + "0,0,3,CAR,0,10,1,4,2,1.5,0,0,0,0,0,0\n" +
              "0,0,3,CAR,0,10,1,4,2,1.5,0,0,0,0,0,0\n",
          "boxes.csv:3: column 't': found '0', expected one box of an object at a time");
  damaged("a/radar_rear.csv", std::string(kRadar) + "1,0.1,15,left,0,9.9,6,1,1\n",
          "radar_rear.csv:2: column 'azimuth': found 'left', expected a number");
  damaged("a/lidar/000007.bin", "12345", "000007.bin");
  damaged("a/lidar/000007.bin", bytesOf<float>({20, 0, 0.5F, 1}),
          "000007.bin: 1 points, expected 3 as in ");
  SetUp();
  fs::remove(file("a/radar_front.csv"));
  expectFault(66, "radar_front.csv", "aimotive", dir());
}

// ------------------------------------------------------------------------- as it was published

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n == 0 ? 0 : (values[(n - 1) / 2] + values[n / 2]) / 2;
}

TEST_F(AimotiveImport, BoxesHoldThePublishedNumbersOfReturns) {
  NEEDS_SHARED_DATA("aimotive");
  ASSERT_EQ(import("aimotive", {"--dir", sharedData("aimotive")}), 0) << error_;
  EXPECT_EQ(result_.scans, 20);
  EXPECT_EQ(result_.images, 30);
  EXPECT_EQ(result_.radar_returns, 1054u + 1119u);
  EXPECT_EQ(result_.truth_types.at("Car"), 5u * 20);
  EXPECT_EQ(result_.truth_types.at("Van"), 2u * 20);
  EXPECT_EQ(result_.truth_types.at("Truck"), 20u);
  const auto scans = framesOf("LIDAR_TOP");
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(scans.size(), truth.instants.size());
  std::map<std::int64_t, std::vector<double>> returns;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const auto& cloud = std::get<LidarCloud>(scans[k].data);
    EXPECT_GE(cloud.size(), 125567u);
    EXPECT_LE(cloud.size(), 129819u);
    const auto [first, last] =
        std::minmax_element(cloud.time_offset.begin(), cloud.time_offset.end());
    EXPECT_NEAR(*first, -0.05, 1e-3);
    EXPECT_NEAR(*last, 0.05, 1e-3);
    const LidarCloud body = inFrame(cloud, scans[k].T_ego_sensor);
    const Pose3 T_body_world = scans[k].ego.T_world_ego.inverse();
    for (const TruthObject& o : truth.instants[k].objects) {
      constexpr double kGrown = 0.1;  // [m] to every side: so the published numbers come out
      const ObjectDetection::SpaceBox box{T_body_world * (o.position - Vector3(0, 0, kGrown)),
                                          o.yaw + yawOf(T_body_world), o.length + 2 * kGrown,
                                          o.width + 2 * kGrown, o.height + 2 * kGrown};
      returns[o.id].push_back(returnsInside(box, body));
    }
  }
  const std::map<std::int64_t, double> published = {{0, 917}, {1, 8058}, {2, 10}, {3, 323},
                                                    {4, 0},   {5, 106},  {6, 51}, {7, 42}};
  for (const auto& [id, count] : published)
    EXPECT_NEAR(medianOf(returns[id]), count, 1 + 0.03 * count) << id;
}

TEST_F(AimotiveImport, VelocitiesAreThoseOfThePlaces) {
  NEEDS_SHARED_DATA("aimotive");
  ASSERT_EQ(import("aimotive", {"--dir", sharedData("aimotive")}), 0) << error_;
  struct Way {
    double t = 0;
    Vector2 from, to, sum = Vector2::Zero();
    int rows = 0;
  };
  std::map<std::int64_t, Way> ways;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    for (const TruthObject& o : instant.objects) {
      Way& way = ways[o.id];
      if (way.rows++ == 0) way.t = instant.t, way.from = o.position.head<2>();
      way.to = o.position.head<2>();
      way.sum += Vector2(o.vx, o.vy);
      if (way.rows < 20) continue;
      const Vector2 slope = (way.to - way.from) / (instant.t - way.t);
      const Vector2 mean = way.sum / way.rows;
      EXPECT_LT((slope - mean).norm(), 0.15) << o.id;
      EXPECT_GT(mean.x(), 20) << o.id;  // all drive with the vehicle
    }
  }
  EXPECT_EQ(ways.size(), 8u);
}

/// What stands closes by the vehicle's own speed: signs of azimuth and rate, the radars' places,
/// the vehicle's motion.
TEST_F(AimotiveImport, StandingTargetsHaveNoSpeedOverGround) {
  NEEDS_SHARED_DATA("aimotive");
  ASSERT_EQ(import("aimotive", {"--dir", sharedData("aimotive")}), 0) << error_;
  for (const char* label : {"RADAR_FRONT", "RADAR_REAR"}) {
    std::vector<double> still;
    int all = 0;
    for (const SensorFrame& scan : framesOf(label)) {
      const Vector3 v(scan.ego.velocity.x(), scan.ego.velocity.y(), 0);
      for (const RadarReturn& r : std::get<RadarReturns>(scan.data).returns) {
        const double e = r.elevation.value_or(0);
        const Vector3 ray = scan.T_world_sensor().linear() *
                            Vector3(std::cos(e) * std::cos(r.bearing),
                                    std::cos(e) * std::sin(r.bearing), std::sin(e));
        const double over_ground = r.range_rate + v.dot(ray);
        ++all;
        if (std::abs(over_ground) < 2) still.push_back(over_ground);
      }
    }
    double square = 0;
    for (const double rate : still) square += rate * rate;
    const double rms = std::sqrt(square / static_cast<double>(still.size()));
    RecordProperty(std::string(label) + "_rms", std::to_string(rms));
    EXPECT_GT(static_cast<double>(still.size()), 0.6 * all) << label;
    EXPECT_LT(std::abs(medianOf(still)), 0.1) << label;
    EXPECT_LT(rms, 0.15) << label;
  }
}

TEST_F(AimotiveImport, TheTrafficIsTracked) {
  NEEDS_SHARED_DATA("aimotive");
  ASSERT_EQ(import("aimotive", {"--dir", sharedData("aimotive")}), 0) << error_;
  const auto scenes = track("aimotive.ini", "L+R");
  int all = 0, near = 0;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    if (instant.t < 1) continue;
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const Scene& s) { return s.frame == instant.frame; });
    ASSERT_NE(scene, scenes.end());
    for (const TruthObject& o : instant.objects) {
      if (o.lidar_points < 20 || o.type == "Truck") continue;
      ++all;
      near += std::any_of(scene->objects.begin(), scene->objects.end(), [&](const auto& object) {
        return (object.position - o.position).template head<2>().norm() < 2.5 &&
               std::abs(object.velocity.x() - o.vx) < 5;
      });
    }
  }
  RecordProperty("all", all);
  RecordProperty("tracked", near);
  ASSERT_GE(all, 40);
  EXPECT_GE(near, (8 * all) / 10);
}

}  // namespace
}  // namespace perception
