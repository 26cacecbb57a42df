#include "libperception/sensors/frames/RangeClouds.h"

#include <gtest/gtest.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/version.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "libperception/core/math/Angle.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/VelodyneCloud.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

mrpt::obs::CObservation2DRangeScan planarScan() {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.timestamp = fromStamp(kStart);
  scan.sensorLabel = "IBEO_LEFT_L2";
  scan.aperture = static_cast<float>(radians(90));
  scan.maxRange = 50;
  scan.resizeScanAndAssign(5, 10.F, true);
  return scan;
}

TEST(RangeClouds, PlanarScanRunsFromRightToLeft) {
  auto scan = planarScan();
  scan.setScanRangeValidity(1, false);
  scan.setScanRange(3, 0);
  std::uint64_t no_range = 0;
  const LidarCloud cloud = planarCloud(scan, no_range);
  ASSERT_EQ(cloud.size(), 3U);
  EXPECT_EQ(no_range, 1U);
  EXPECT_NEAR(cloud.x[0], 10 * std::cos(radians(45)), 1e-5);
  EXPECT_NEAR(cloud.y[0], -10 * std::sin(radians(45)), 1e-5);
  EXPECT_NEAR(cloud.y[2], 10 * std::sin(radians(45)), 1e-5);
  EXPECT_NEAR(cloud.x[1], 10, 1e-5);
  EXPECT_EQ(cloud.max_range, 50);
  scan.rightToLeft = false;
  EXPECT_GT(planarCloud(scan, no_range).y[0], 0);
}

TEST(RangeClouds, NoddingScannerEndsLower) {
  auto scan = planarScan();
  scan.deltaPitch = 0.2;
  std::uint64_t no_range = 0;
  const LidarCloud cloud = planarCloud(scan, no_range);
  EXPECT_NEAR(cloud.z[0], 0, 1e-6);
  EXPECT_NEAR(cloud.z[2], -10 * std::sin(0.1), 1e-5);
  EXPECT_NEAR(std::hypot(cloud.x[4], cloud.y[4], cloud.z[4]), 10, 1e-5);
}

TEST(RangeClouds, PlanarScansOfALogAreLidarFrames) {
  auto scan = planarScan();
  scan.setSensorPose(mrpt::poses::CPose3D(3.8, 0.8, 0.6, 0.7, -0.02, 0));
  scan.setScanHasIntensity(true);
  for (std::size_t i = 0; i < 5; ++i) scan.setScanIntensity(i, 4000);
  const auto frame = frameFromObservation(scan);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(isSensorData(scan));
  EXPECT_EQ(std::get<LidarCloud>(frame->data).size(), 5U);
  EXPECT_NEAR(std::get<LidarCloud>(frame->data).intensity[0], 4000. / 65535, 1e-6);
  EXPECT_TRUE(frame->T_ego_sensor.isApprox(makePose(3.8, 0.8, 0.6, 0.7, -0.02, 0), 1e-9));
}

mrpt::obs::CObservation3DRangeScan rangeImage() {
  mrpt::obs::CObservation3DRangeScan scan;
  scan.timestamp = fromStamp(kStart);
  scan.maxRange = 20;
  scan.hasRangeImage = true;
  scan.rangeUnits = 0.01F;
  scan.rangeImage_setSize(3, 5);
  scan.rangeImage.fill(500);
  scan.cameraParams.ncols = 5, scan.cameraParams.nrows = 3;
  scan.cameraParams.setIntrinsicParamsFromValues(4, 4, 2, 1);
  return scan;
}

TEST(RangeClouds, DepthAndRangeAreToldApart) {
  auto scan = rangeImage();
  scan.rangeImage(0, 0) = 0;
  std::uint64_t no_range = 0;
  scan.range_is_depth = true;
  const auto depth = rangeImageCloud(scan, no_range);
  ASSERT_TRUE(depth);
  ASSERT_EQ(depth->size(), 14U);
  EXPECT_EQ(no_range, 1U);
  for (std::size_t i = 0; i < depth->size(); ++i) EXPECT_NEAR(depth->x[i], 5, 1e-5);
  EXPECT_NEAR(depth->y[0], 5 * 0.25, 1e-5);  // column 1 lies left of the middle
  EXPECT_NEAR(depth->z[0], 5 * 0.25, 1e-5);  // row 0 above it
  scan.range_is_depth = false;
  const auto range = rangeImageCloud(scan, no_range);
  for (std::size_t i = 0; i < range->size(); ++i)
    EXPECT_NEAR(std::hypot(range->x[i], range->y[i], range->z[i]), 5, 1e-5);
}

TEST(RangeClouds, PixelLabelsByTheirNamesBecomePointLabels) {
  auto scan = rangeImage();
  auto labels = std::make_shared<mrpt::obs::TPixelLabelInfo<1>>();
  labels->setSize(3, 5);
  labels->setLabelName(0, "ground");
  labels->setLabelName(3, "object");
  labels->setLabel(0, 0, 0);
  labels->setLabel(2, 4, 3);
  scan.pixelLabels = labels;
  const auto frame = frameFromObservation(scan);
  ASSERT_TRUE(frame);
  const auto& cloud = std::get<LidarCloud>(frame->data);
  ASSERT_EQ(cloud.label.size(), 15U);
  EXPECT_EQ(cloud.label[0], static_cast<int>(PointLabel::kGround));
  EXPECT_EQ(cloud.label[1], static_cast<int>(PointLabel::kUnknown));
  EXPECT_EQ(cloud.label[14], static_cast<int>(PointLabel::kObject));
}

TEST(RangeClouds, PointsWithoutAnImageAreTakenAndNothingIsRejected) {
  mrpt::obs::CObservation3DRangeScan scan;
  scan.timestamp = fromStamp(kStart);
  DecodeCounts counts;
  EXPECT_FALSE(frameFromObservation(scan, &counts));
  EXPECT_EQ(counts.rejected, 1U);
  scan.hasPoints3D = true;
  scan.points3D_x = {1, 2}, scan.points3D_y = {3, 4}, scan.points3D_z = {0, 1};
  const auto frame = frameFromObservation(scan, &counts);
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<LidarCloud>(frame->data).y, (std::vector<float>{3, 4}));
  scan.points3D_z = {0};
  EXPECT_FALSE(frameFromObservation(scan, &counts));
  EXPECT_EQ(counts.rejected, 2U);
}

TEST(RangeClouds, RotatingScanOfAnUnknownModelIsRejected) {
  mrpt::obs::CObservationRotatingScan scan;
  scan.rowCount = 16, scan.columnCount = 10;
  scan.rangeImage.setSize(16, 10);
  scan.rangeResolution = 0.01;
  std::uint64_t no_range = 0;
  scan.lidarModel = "UNKNOWN_SCANNER";
  EXPECT_FALSE(rotatingCloud(scan, no_range));
  scan.lidarModel = "VLP-16";
  scan.rangeImage(0, 0) = 300, scan.rangeImage(1, 9) = 50;  // [cm]
  const auto cloud = rotatingCloud(scan, no_range);
  ASSERT_TRUE(cloud);
  ASSERT_EQ(cloud->size(), 1U);
  EXPECT_EQ(no_range, 1U);  // half a meter is below the instrument's range
  EXPECT_NEAR(cloud->z[0], 3 * std::sin(radians(-15)), 1e-5);
  scan.rowCount = 12;
  EXPECT_FALSE(rotatingCloud(scan, no_range));
}

// MRPT's sample holds one turn of a VLP-16 both as packets and as a range image.
TEST(RangeClouds, RealRotatingScanAgreesWithItsPackets) {
  const std::string samples = std::string(PERCEPTION_SHARED_DATA) + "/data/mrpt_samples/";
  const std::string image_file = samples + "rot_scan_velodyne.rawlog";
  const std::string packet_file = samples + "test_velodyne_VLP16.rawlog";
  if (!std::filesystem::exists(image_file)) GTEST_SKIP() << "no " << image_file;
  if (MRPT_VERSION >= 0x020e00) GTEST_SKIP() << "MRPT 2.14 cannot read turns that MRPT 2.5 wrote";
  RawlogReader images(image_file), packets(packet_file);
  const auto image = frameFromObservation(*images.next());
  const auto packet = frameFromObservation(*packets.next());
  ASSERT_TRUE(image && packet);
  const auto& a = std::get<LidarCloud>(image->data);
  const auto& b = std::get<LidarCloud>(packet->data);
  EXPECT_GT(a.size(), 10000U);
  // Every hundredth point of the image has one of the packets' within half a meter (a column is
  // 2.2 cm at 10 m; MRPT spreads them evenly over a turn that is not even).
  std::size_t near = 0, looked = 0;
  for (std::size_t i = 0; i < a.size(); i += 100) {
    ++looked;
    for (std::size_t k = 0; k < b.size(); ++k) {
      const float dx = a.x[i] - b.x[k], dy = a.y[i] - b.y[k], dz = a.z[i] - b.z[k];
      if (dx * dx + dy * dy + dz * dz < 0.25F) {
        ++near;
        break;
      }
    }
  }
  EXPECT_GT(near, looked * 95 / 100);
}

}  // namespace
}  // namespace perception
