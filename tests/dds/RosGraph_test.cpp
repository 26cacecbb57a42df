#include "libperception/dds/RosGraph.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <thread>

namespace perception {
namespace {

/// A domain that no other test on this machine is likely to have.
NetworkName ownDomain() { return {"lo", 100 + static_cast<std::uint32_t>(::getpid()) % 100}; }

bool happens(const std::function<bool()>& condition) {
  for (int i = 0; i < 250; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

TEST(RosGraph, NamesOnTheWireAreThoseOfRos) {
  EXPECT_EQ(wireTopicOf("/front/points"), "rt/front/points");
  EXPECT_EQ(*rosTopicOf("rt/front/points"), "/front/points");
  EXPECT_FALSE(rosTopicOf("rq/camera/set_infoRequest")) << "a service";
  EXPECT_FALSE(rosTopicOf("perception/observations"));
  EXPECT_EQ(wireTypeOf("sensor_msgs/PointCloud2"), "sensor_msgs::msg::dds_::PointCloud2_");
  EXPECT_EQ(*rosTypeOf("sensor_msgs::msg::dds_::PointCloud2_"), "sensor_msgs/PointCloud2");
  EXPECT_FALSE(rosTypeOf("std_srvs::srv::dds_::Trigger_Request_"));
  EXPECT_FALSE(rosTypeOf("::msg::dds_::X_"));
}

TEST(RosGraph, TopicsComeAndGoWithTheirWriters) {
  const auto network = Network::join(ownDomain());
  RosGraph graph(network);
  TopicQuality latched;
  latched.latched = true;
  {
    const RawWriter fixed(network, "rt/tf_static", wireTypeOf("tf2_msgs/TFMessage"), latched);
    const RawWriter service(network, "rq/ask", wireTypeOf("std_msgs/Bool"));
    ASSERT_TRUE(happens([&] { return graph.look().count("/tf_static") == 1; }));
    const auto topics = graph.look();
    EXPECT_EQ(topics.size(), 1U);
    EXPECT_EQ(topics.at("/tf_static").type, "tf2_msgs/TFMessage");
    EXPECT_TRUE(topics.at("/tf_static").quality == latched);
  }
  EXPECT_TRUE(happens([&] { return graph.look().empty(); }));
}

TEST(RawTopic, MessagesComeWholeAsBytesAndAreCounted) {
  const auto network = Network::join(ownDomain());
  RawWriter writer(network, "rt/raw", wireTypeOf("std_msgs/String"));
  RawReader reader(network, "rt/raw", wireTypeOf("std_msgs/String"), {}, 4);
  ASSERT_TRUE(happens([&] { return writer.hasReaders(); }));
  const std::string large = std::string("\0\1\0\0", 4) + std::string(3'000'000, 'x');
  ASSERT_TRUE(writer.write(large));
  std::vector<RawReader::Message> came;
  ASSERT_TRUE(happens([&] {
    came = reader.take();
    return !came.empty();
  }));
  EXPECT_EQ(came[0].bytes, large);
  for (int i = 0; i < 10; ++i) writer.write(std::string("\0\1\0\0abcd", 8));
  ASSERT_TRUE(happens([&] { return reader.ledger().received == 11; }));
  EXPECT_EQ(reader.take().size(), 4U) << "as many as may wait";
  EXPECT_EQ(reader.ledger().overrun, 6U);
  EXPECT_FALSE(writer.write("")) << "without the head of an encoding";
}

TEST(RawTopic, WhoComesLateGetsWhatIsLatched) {
  const auto network = Network::join(ownDomain());
  TopicQuality latched;
  latched.latched = true;
  RawWriter writer(network, "rt/late", wireTypeOf("std_msgs/String"), latched);
  ASSERT_TRUE(writer.write(std::string("\0\1\0\0abcd", 8)));
  RawReader reader(network, "rt/late", wireTypeOf("std_msgs/String"), latched, 4);
  EXPECT_TRUE(happens([&] { return reader.take().size() == 1; }));
}

}  // namespace
}  // namespace perception
