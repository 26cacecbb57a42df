// Everything stays on the loopback interface; domain 77 is not that of a robot beside us.
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <thread>

#include <messages.h>  // of messages.idl
#include "libperception/core/Error.h"
#include "libperception/dds/ObservationTopic.h"
#include "libperception/dds/RosTopics.h"

namespace perception {
namespace {

const NetworkName kNetwork{"lo", 77};

bool comesTrue(const std::function<bool()>& condition) {
  for (int i = 0; i < 250 && !condition(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return condition();
}

TEST(NetworkName, IsAnInterfaceAndADomain) {
  EXPECT_EQ(NetworkName::parse("lo").domain, 0U);
  EXPECT_EQ(NetworkName::parse("enp3s0:42").interface, "enp3s0");
  EXPECT_EQ(NetworkName::parse("enp3s0:42").domain, 42U);
  for (const char* wrong : {"", ":1", "lo:", "lo:x", "lo:231", "lo:-1", "l<o", "lo:1:2"})
    EXPECT_THROW(NetworkName::parse(wrong), Error) << wrong;
}

TEST(Network, AnInterfaceThatIsNotThereIsNamed) {
  try {
    Network::join({"nosuch0", 78});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kUnavailable);
    EXPECT_NE(std::string(error.what()).find("nosuch0"), std::string::npos);
  }
}

TEST(ObservationTopic, WhatIsPublishedComesWholeAndInOrder) {
  ObservationSubscriber subscriber(kNetwork);
  ObservationPublisher publisher(kNetwork);
  mrpt::obs::CObservationOdometry odometry;
  odometry.sensorLabel = "WHEELS";
  std::vector<double> got;
  double sent = 0;
  // Publishing begins before the two have found each other: what comes is whole from then on.
  EXPECT_TRUE(comesTrue([&] {
    odometry.odometry.x(++sent);
    EXPECT_TRUE(publisher.publish(odometry));
    for (const auto& o : subscriber.take()) {
      EXPECT_EQ(o->sensorLabel, "WHEELS");
      got.push_back(dynamic_cast<const mrpt::obs::CObservationOdometry&>(*o).odometry.x());
    }
    return got.size() >= 20;
  }));
  for (std::size_t i = 1; i < got.size(); ++i) EXPECT_EQ(got[i], got[i - 1] + 1);
  EXPECT_EQ(subscriber.ledger().received, got.size());
  EXPECT_EQ(subscriber.ledger().lost + subscriber.ledger().damaged, 0U);
}

TEST(RosTopics, ANodeReadsTracksAndClouds) {
  const auto network = Network::join(kNetwork);
  const int tracks = network->reader(vision_msgs_msg_dds__Detection3DArray__desc, "rt/tracks");
  const int clouds = network->reader(sensor_msgs_msg_dds__PointCloud2__desc, "rt/TOP");
  RosTopics topics(kNetwork, {"car", "pedestrian"});
  Scene scene;
  scene.stamp = {1'500'000'000'250'000'000};
  SceneObject object;
  object.id = 12;
  object.position = {10, -2, 0.5};
  object.length = 4, object.width = 2, object.height = 1.5;
  object.existence = 0.5;
  object.class_probability = {0.8, 0.2};
  scene.objects.push_back(object);
  SensorFrame frame;
  frame.stamp = scene.stamp;
  frame.sensor = "TOP";
  LidarCloud cloud;
  cloud.x = {1, 4}, cloud.y = {2, 5}, cloud.z = {3, 6};
  frame.data = cloud;

  void* message[1] = {nullptr};
  dds_sample_info_t info[1];
  ASSERT_TRUE(comesTrue([&] {
    topics.publish(scene);
    return dds_take(tracks, message, info, 1, 1) == 1;
  }));
  const auto& array = *static_cast<const vision_msgs_msg_dds__Detection3DArray_*>(message[0]);
  EXPECT_EQ(array.header.stamp.sec, 1'500'000'000);
  EXPECT_EQ(array.header.stamp.nanosec, 250'000'000U);
  EXPECT_STREQ(array.header.frame_id, "map");
  ASSERT_EQ(array.detections._length, 1U);
  const auto& d = array.detections._buffer[0];
  EXPECT_STREQ(d.id, "12");
  EXPECT_EQ(d.bbox.center.position.x, 10);
  EXPECT_EQ(d.bbox.center.position.z, 0.5 + 0.75);
  EXPECT_EQ(d.bbox.size.x, 4);
  ASSERT_EQ(d.results._length, 2U);
  EXPECT_STREQ(d.results._buffer[0].hypothesis.class_id, "car");
  EXPECT_DOUBLE_EQ(d.results._buffer[0].hypothesis.score, 0.4);
  dds_return_loan(tracks, message, 1);

  message[0] = nullptr;
  ASSERT_TRUE(comesTrue([&] {
    topics.publish(frame);
    return dds_take(clouds, message, info, 1, 1) == 1;
  }));
  const auto& points = *static_cast<const sensor_msgs_msg_dds__PointCloud2_*>(message[0]);
  EXPECT_STREQ(points.header.frame_id, "TOP");
  EXPECT_EQ(points.width * points.height, 2U);
  float z = 0;
  std::memcpy(&z, points.data._buffer + points.point_step + 8, sizeof z);
  EXPECT_EQ(z, 6);
  dds_return_loan(clouds, message, 1);
}

}  // namespace
}  // namespace perception
