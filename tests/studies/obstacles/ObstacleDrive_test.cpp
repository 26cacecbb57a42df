#include "studies/obstacles/ObstacleDrive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"

namespace perception {
namespace {

const ObstacleShape& shapeNamed(const std::string& name) {
  const auto& all = obstacleShapes();
  return *std::find_if(all.begin(), all.end(),
                       [&](const ObstacleShape& shape) { return shape.name == name; });
}

ObstacleDriveParams towards(const std::string& shape, DriveWay way) {
  ObstacleDriveParams params;
  params.shape = &shapeNamed(shape);
  params.distance = 20;
  params.way = way;
  params.lidar = "LIDAR_TOP";
  return params;
}

/// Mean place of the shape's returns in a scan, world.
Vector3 placeSeen(ObstacleDrive& drive, std::size_t number) {
  const LidarSensor::Scan& scan = drive.scan(number);
  const Pose3 T_world_lidar =
      drive.ego(static_cast<double>(number) / ObstacleDrive::kRate).T_world_ego *
      drive.T_ego_lidar();
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    if (!drive.isOfShape(scan, i)) continue;
    sum += T_world_lidar * Vector3(static_cast<double>(scan.cloud.x[i]),
                                   static_cast<double>(scan.cloud.y[i]),
                                   static_cast<double>(scan.cloud.z[i]));
    ++count;
  }
  EXPECT_GE(count, 10);
  return sum / std::max(1, count);
}

TEST(ObstacleDrive, EveryWayLeadsToTheShape) {
  for (const DriveWay way :
       {DriveWay::kForward, DriveWay::kBackward, DriveWay::kLeft, DriveWay::kRight}) {
    ObstacleDrive drive(towards("drum", way));
    const Vector3 there = drive.ego(2).T_world_ego.translation();
    for (const std::size_t number : {std::size_t{0}, std::size_t{10}})
      EXPECT_LT((placeSeen(drive, number) - there).head<2>().norm(), 0.5);
  }
}

TEST(ObstacleDrive, BackwardTheVehicleLooksAwayFromTheShape) {
  const ObstacleDrive drive(towards("drum", DriveWay::kBackward));
  const EgoState ego = drive.ego(1);
  EXPECT_LT(ego.velocity.dot(ego.T_world_ego.linear().col(0).head<2>()), 0);
}

TEST(ObstacleDrive, MoreBeamsSeeMoreOfAShape) {
  std::size_t before = 0;
  for (const int beams : {16, 32, 64, 128}) {
    ObstacleDriveParams params = towards("lorry's tail", DriveWay::kForward);
    params.beams = beams;
    ObstacleDrive drive(params);
    const LidarSensor::Scan& scan = drive.scan(0);
    std::size_t returns = 0;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) returns += drive.isOfShape(scan, i);
    EXPECT_GT(returns, before) << beams;
    before = returns;
  }
  EXPECT_THROW(lidarOfBeams(40), Error);
}

TEST(ObstacleDrive, AnOutlineLeavesOutWhatHangsHigher) {
  const ObstacleDrive gantry(towards("gantry", DriveWay::kForward));
  for (const Vector3& p : gantry.outline(2)) EXPECT_GT(std::abs(p.y()), 3);
  const ObstacleDrive bar(towards("bar of 10 cm at .6 m", DriveWay::kForward));
  for (const Vector3& p : bar.outline(2)) EXPECT_NEAR(p.x(), 20.05, 0.06);
}

}  // namespace
}  // namespace perception
