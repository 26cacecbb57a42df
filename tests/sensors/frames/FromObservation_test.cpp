#include "libperception/sensors/frames/FromObservation.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <limits>

#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(FromObservation, AReturnAtTheLargestRangeIsKeptWhereFloatsRoundItBeyond) {
  LidarCloud cloud;
  cloud.max_range = 120;
  for (int k = 0; k < 1000; ++k) {
    const double bearing = kTwoPi * k / 1000;
    cloud.x.push_back(static_cast<float>(120 * std::cos(bearing)));
    cloud.y.push_back(static_cast<float>(120 * std::sin(bearing)));
    cloud.z.push_back(0);
  }
  DecodeCounts counts;
  dropBadPoints(cloud, counts);
  EXPECT_EQ(counts.beyond_range, 0U);
  EXPECT_EQ(cloud.size(), 1000U);
}

TEST(FrameFromObservation, LidarScanIsTheInverseOfToObservation) {
  const auto scan = fullScan(100, kStart + 1.25);
  const auto frame = frameFromObservation(*scan);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->sensor, "LIDAR_TOP");
  EXPECT_EQ(frame->stamp.ns, kStart.ns + 1'250'000'000);
  EXPECT_EQ(frame->frame, -1);
  EXPECT_TRUE(frame->T_ego_sensor.isApprox(makePose(0.5, -0.25, 1.73, 0.1, 0.02, -0.01), 1e-9));
  const auto& cloud = std::get<LidarCloud>(frame->data);
  EXPECT_EQ(cloud.x, scan->cloud.x);
  EXPECT_EQ(cloud.ring, scan->cloud.ring);
}

TEST(FrameFromObservation, ALidarScanThatIsNotNeededGivesItsPointsAway) {
  const auto scan = fullScan(100, kStart);
  const auto kept = frameFromObservation(*scan);
  DecodeCounts counts;
  const auto moved = frameFromObservation(std::move(*scan), counts);
  ASSERT_TRUE(kept && moved);
  EXPECT_EQ(moved->stamp, kept->stamp);
  EXPECT_EQ(counts.points, 100U);
  const auto &one = std::get<LidarCloud>(kept->data), &other = std::get<LidarCloud>(moved->data);
  EXPECT_EQ(one.x, other.x);
  EXPECT_EQ(one.intensity, other.intensity);
  EXPECT_EQ(one.max_range, other.max_range);
  EXPECT_TRUE(scan->cloud.x.empty());
}

TEST(FrameFromObservation, BadPointsAreDroppedAndCountedAndTheRestIsUnchanged) {
  const auto good = fullScan(50);
  auto bad = fullScan(50);
  const auto insert = [&bad](std::size_t at, float x, float y, float z) {
    auto& c = bad->cloud;
    const auto put = [at](auto& values, auto value) {
      values.insert(values.begin() + static_cast<std::ptrdiff_t>(at),
                    static_cast<std::decay_t<decltype(values[0])>>(value));
    };
    put(c.x, x);
    put(c.y, y);
    put(c.z, z);
    put(c.intensity, 0.5F);
    put(c.ring, 1);
    put(c.time_offset, 0.F);
    put(c.echo, 0);
    put(c.pulse_width, 0.F);
    put(c.label, 0);
  };
  insert(0, kNan, 1, 1);
  insert(10, 1, kInf, 1);
  insert(11, 1, 1, -kInf);
  insert(30, 0, 0, 0);
  insert(54, 119, 30, 0);
  DecodeCounts counts;
  const auto frame = frameFromObservation(*bad, &counts);
  ASSERT_TRUE(frame);
  EXPECT_EQ(counts.points, 55U);
  EXPECT_EQ(counts.not_finite, 3U);
  EXPECT_EQ(counts.no_range, 1U);
  EXPECT_EQ(counts.beyond_range, 1U);
  EXPECT_EQ(counts.dropped(), 5U);
  const auto& cloud = std::get<LidarCloud>(frame->data);
  EXPECT_EQ(cloud.x, good->cloud.x);
  EXPECT_EQ(cloud.z, good->cloud.z);
  EXPECT_EQ(cloud.intensity, good->cloud.intensity);
  EXPECT_EQ(cloud.echo, good->cloud.echo);
  EXPECT_EQ(cloud.label, good->cloud.label);
}

TEST(FrameFromObservation, ABadPointAnywhereAmongManyIsDropped) {
  for (const float z : {kNan, 0.0F, 120.1F, 1e-30F}) {
    for (std::size_t at = 0; at < 100; at += 7) {
      auto scan = fullScan(100);
      scan->cloud.x[at] = scan->cloud.y[at] = 0, scan->cloud.z[at] = z;
      DecodeCounts counts;
      const auto frame = frameFromObservation(*scan, &counts);
      ASSERT_TRUE(frame);
      EXPECT_EQ(counts.dropped(), z == 1e-30F ? 0U : 1U) << z << " " << at;
      EXPECT_EQ(std::get<LidarCloud>(frame->data).size(), 100 - counts.dropped());
    }
  }
}

TEST(FrameFromObservation, EmptyAndAllBadCloudsAreFramesWithoutPoints) {
  auto scan = fullScan(3);
  scan->cloud.x.assign(3, kNan);
  const auto frame = frameFromObservation(*scan);
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<LidarCloud>(frame->data).size(), 0U);
  EXPECT_TRUE(std::get<LidarCloud>(frame->data).ring.empty());
  EXPECT_TRUE(frameFromObservation(*fullScan(0)));
}

TEST(FrameFromObservation, MrptCloudsOfBothKindsAreRead) {
  auto plain = std::make_shared<mrpt::maps::CSimplePointsMap>();
  plain->insertPoint(1, 2, 3);
  plain->insertPoint(0, 0, 0);
  mrpt::obs::CObservationPointCloud observation;
  observation.timestamp = fromStamp(kStart);
  observation.sensorLabel = "L";
  observation.sensorPose = mrpt::poses::CPose3D(1, 2, 3, 0, 0, 0);
  observation.pointcloud = plain;
  DecodeCounts counts;
  const auto frame = frameFromObservation(observation, &counts);
  ASSERT_TRUE(frame);
  EXPECT_EQ(counts.no_range, 1U);
  EXPECT_EQ(std::get<LidarCloud>(frame->data).z, std::vector<float>{3});
  EXPECT_TRUE(std::get<LidarCloud>(frame->data).intensity.empty());

  auto with_intensity = std::make_shared<mrpt::maps::CPointsMapXYZI>();
  with_intensity->resize(2);
  with_intensity->setPointRGB(0, 1, 2, 3, 255, 255, 255);
  with_intensity->setPointRGB(1, 4, 5, 6, 51, 51, 51);
  with_intensity->setPointIntensity(0, 255);
  with_intensity->setPointIntensity(1, 51);
  observation.pointcloud = with_intensity;
  const auto bytes = frameFromObservation(observation);
  ASSERT_TRUE(bytes);
  EXPECT_FLOAT_EQ(std::get<LidarCloud>(bytes->data).intensity[0], 1);
  EXPECT_FLOAT_EQ(std::get<LidarCloud>(bytes->data).intensity[1], 0.2F);
  observation.pointcloud.reset();
  EXPECT_FALSE(frameFromObservation(observation, &counts));
  EXPECT_EQ(counts.rejected, 1U);
}

TEST(FrameFromObservation, BadBoxesAreDroppedAndCounted) {
  auto o = someDetections();
  auto bad = o->detections.objects[0];
  bad.space_box->length = -1;
  o->detections.objects.push_back(bad);
  bad = o->detections.objects[1];
  bad.image_box->x2 = std::numeric_limits<double>::quiet_NaN();
  o->detections.objects.insert(o->detections.objects.begin(), bad);
  DecodeCounts counts;
  const auto frame = frameFromObservation(*o, &counts);
  ASSERT_TRUE(frame);
  EXPECT_EQ(counts.bad_boxes, 2U);
  const auto& objects = std::get<ObjectDetections>(frame->data).objects;
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].label, "Car");
  EXPECT_TRUE(std::get<ObjectDetections>(frame->data).T_ego_camera);
}

TEST(FrameFromObservation, UnusableStampsAreRejected) {
  auto scan = fullScan(3);
  DecodeCounts counts;
  for (const auto& stamp :
       {INVALID_TIMESTAMP, mrpt::Clock::fromDouble(0), mrpt::Clock::fromDouble(4294967296.0)}) {
    scan->timestamp = stamp;
    EXPECT_FALSE(frameFromObservation(*scan, &counts));
  }
  EXPECT_EQ(counts.rejected_stamps, 3U);
}

TEST(FrameFromObservation, OtherClassesGiveNothing) {
  mrpt::obs::CObservationOdometry odometry;
  EXPECT_FALSE(frameFromObservation(odometry));
  EXPECT_FALSE(isSensorData(odometry));
  EXPECT_TRUE(isSensorData(*fullScan(1)));
}

TEST(Stamps, ConvertExactlyBothWays) {
  EXPECT_EQ(toStamp(mrpt::Clock::fromDouble(1317038400.0))->ns, kStart.ns);
  for (const std::int64_t ns : {100LL, 1'317'038'400'123'456'700LL, 4'294'967'295'999'999'900LL}) {
    EXPECT_EQ(toStamp(fromStamp({ns}))->ns, ns);
  }
  EXPECT_EQ(toStamp(fromStamp({1'000'000'099}))->ns, 1'000'000'000);
}

TEST(FrameNumber, IsReadFromTheCommentOnly) {
  EXPECT_EQ(frameNumber(*frameComment(kStart, 42)), 42);
  mrpt::obs::CObservationComment comment;
  for (const char* text :
       {"", "frame", "frame ", "frame x", "frame 1 2", "a frame 1", "frame 99999999999999999999"}) {
    comment.text = text;
    EXPECT_FALSE(frameNumber(comment)) << text;
  }
  EXPECT_FALSE(frameNumber(*fullScan(1)));
}

TEST(FromObservation, DropsAndCountsRadarReturnsThatAreNone) {
  const auto o = someReturns();
  RadarReturn nowhere = o->scan.returns[0], corrupted = o->scan.returns[0];
  nowhere.range = 0;
  corrupted.range_rate = std::numeric_limits<double>::quiet_NaN();
  o->scan.returns.push_back(nowhere);
  o->scan.returns.push_back(corrupted);
  DecodeCounts counts;
  const auto frame = frameFromObservation(*o, &counts);
  ASSERT_TRUE(frame);
  EXPECT_EQ(std::get<RadarReturns>(frame->data).returns.size(), 2U);
  EXPECT_EQ(counts.bad_returns, 2U);
  EXPECT_NEAR(frame->T_ego_sensor.translation().x(), 3.5, 1e-12);
}

}  // namespace
}  // namespace perception
