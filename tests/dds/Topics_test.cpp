// Everything stays on the loopback interface; domain 77 is not that of a robot beside us.
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <thread>

#include <ros.h>  // of ros.idl
#include "libperception/core/Error.h"
#include "libperception/dds/ObservationTopic.h"
#include "libperception/dds/RosTopics.h"
#include "libperception/grid/SafetyGrid.h"

namespace perception {
namespace {

const NetworkName kNetwork{"lo", 77};

bool comesTrue(const std::function<bool()>& condition) {
  for (int i = 0; i < 250; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
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
  RosTopics topics({kNetwork, {"car", "pedestrian"}});
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

/// The next message of a reader, sent again and again until it comes.
template <class Message>
class Next {
 public:
  Next(int reader, const std::function<void()>& send) : reader_(reader) {
    dds_sample_info_t info[1];
    came_ = comesTrue([&] {
      send();
      return dds_take(reader_, message_, info, 1, 1) == 1;
    });
  }
  ~Next() {
    if (came_) dds_return_loan(reader_, message_, 1);
  }
  explicit operator bool() const { return came_; }
  const Message* operator->() const { return static_cast<const Message*>(message_[0]); }

 private:
  int reader_;
  void* message_[1] = {nullptr};
  bool came_ = false;
};

TEST(RosTopics, ANodeReadsMarksMapStopAdviceAndDiagnostics) {
  const auto network = Network::join(kNetwork);
  const int marks =
      network->reader(visualization_msgs_msg_dds__MarkerArray__desc, "rt/tracks/markers");
  const int maps = network->reader(nav_msgs_msg_dds__OccupancyGrid__desc, "rt/grid");
  const int stops = network->reader(std_msgs_msg_dds__Bool__desc, "rt/stop");
  const int distances = network->reader(std_msgs_msg_dds__Float64__desc, "rt/free_distance");
  const int states =
      network->reader(diagnostic_msgs_msg_dds__DiagnosticArray__desc, "rt/diagnostics");
  RosTopics topics({kNetwork, {"car"}, "odom", false});
  Scene scene;
  scene.stamp = {1'500'000'000'000'000'000};
  scene.ego.T_world_ego = makePose(100, 50, 0, 0);
  SceneObject object;
  object.id = 12;
  object.position = {110, 48, 0.5};
  object.length = 4, object.width = 2, object.height = 1.5;
  object.existence = 0.5;
  object.velocity = {0, 3};
  object.class_probability = {1};
  scene.objects.push_back(object);
  scene.path = FreePath{};
  scene.path->distance = 7.5;
  scene.path->stop = true;
  const auto send = [&] { topics.publish(scene); };

  const Next<visualization_msgs_msg_dds__MarkerArray_> shown(marks, send);
  ASSERT_TRUE(shown);
  ASSERT_EQ(shown->markers._length, 4U) << "removes those before; box, text, arrow";
  EXPECT_EQ(shown->markers._buffer[0].action, 3);
  const auto& box = shown->markers._buffer[1];
  EXPECT_STREQ(box.header.frame_id, "odom");
  EXPECT_EQ(box.id, 12);
  EXPECT_EQ(box.type, 1);
  EXPECT_EQ(box.pose.position.x, 110);
  EXPECT_EQ(box.scale.z, 1.5);
  EXPECT_FLOAT_EQ(box.color.a, 0.5F);
  EXPECT_STREQ(shown->markers._buffer[2].text, "car 12?\n3.0 m/s");
  EXPECT_NEAR(shown->markers._buffer[3].pose.orientation.z, std::sqrt(0.5), 1e-12);

  const Next<std_msgs_msg_dds__Bool_> stop(stops, send);
  ASSERT_TRUE(stop);
  EXPECT_TRUE(stop->data);
  const Next<std_msgs_msg_dds__Float64_> distance(distances, send);
  ASSERT_TRUE(distance);
  EXPECT_EQ(distance->data, 7.5);

  GridParams params;
  const auto grid = makeSafetyGrid(params);
  GridScan scan;
  scan.stamp = scene.stamp;
  scan.origin = {100, 50, 1.5};
  scan.T_world_ground = makePose(100, 50, 0, 0);
  for (int i = 0; i < 4; ++i) scan.hits.push_back({110.1, 50.1, 1.1});
  for (int i = 0; i < 5; ++i) grid->insert(scan);
  RosTopics maps_alone({kNetwork, {"car"}, "odom", false});
  const Next<nav_msgs_msg_dds__OccupancyGrid_> map(maps,
                                                   [&] { maps_alone.publish(scene, grid.get()); });
  ASSERT_TRUE(map);
  ASSERT_EQ(map->data._length, map->info.width * map->info.height);
  const auto valueAt = [&](double x, double y) {
    const double r = static_cast<double>(map->info.resolution);
    const auto column = static_cast<unsigned>((x - map->info.origin.position.x) / r);
    const auto row = static_cast<unsigned>((y - map->info.origin.position.y) / r);
    return map->data._buffer[row * map->info.width + column];
  };
  EXPECT_GT(valueAt(110.1, 50.1), 80) << "occupied";
  EXPECT_GE(valueAt(105.1, 50.05), 0);
  EXPECT_LT(valueAt(105.1, 50.05), 50) << "free";
  EXPECT_EQ(valueAt(100.1, 80), -1) << "not known";

  const Next<diagnostic_msgs_msg_dds__DiagnosticArray_> state(states, [&] {
    topics.publish(scene.stamp,
                   {{2, "perception: sensor TOP", "blind", "TOP", {{"since", "4 s"}}}});
  });
  ASSERT_TRUE(state);
  ASSERT_EQ(state->status._length, 1U);
  EXPECT_EQ(state->status._buffer[0].level, 2);
  EXPECT_STREQ(state->status._buffer[0].message, "blind");
  EXPECT_STREQ(state->status._buffer[0].values._buffer[0].value, "4 s");
}

}  // namespace
}  // namespace perception
