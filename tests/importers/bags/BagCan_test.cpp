// Frames of a CAN bus in messages: what a radar sends comes in as by its own decoder.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/packets/Encoder.h"
#include "libperception/packets/FrameAssembler.h"
#include "libperception/packets/radars/CanBundle.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kBusStart = 1'700'000'000'000'000'000;  // [ns]

class BagCan : public test::ImportRun {
 protected:
  /// Three scans of an ESR with two targets, as messages and by its decoder.
  void SetUp() override {
    const auto device = makeEsrEncoder("");
    FrameAssembler assembler(deviceKind("esr"), "", "can", Pose3::Identity(),
                             [this](SensorFrame&& scan) { expected_.push_back(scan); });
    SensorFrame frame;
    frame.stamp = Stamp{kBusStart};
    RadarReturn near, far;
    near.range = 20, near.bearing = 0.1, near.range_rate = -5, near.id = 3;
    far.range = 60, far.bearing = -0.1, far.range_rate = 2, far.id = 9;
    frame.data = RadarReturns{{near, far}, 0};
    for (int scan = 0; scan < 3; ++scan) {
      for (const TimedPacket& packet : device->encode(frame, 0.05)) {
        const Stamp stamp = frame.stamp + packet.after;
        sent_.emplace_back(stamp, packet.payload);
        assembler.add(packet.payload, stamp);
      }
      frame.stamp = frame.stamp + 0.05;
    }
    assembler.finish();
  }
  static std::string message(Stamp stamp, const std::string& payload) {
    ros::CanFrame frame;
    frame.header = {stamp, "base_link"};
    frame.id = canId(payload);
    std::string data = payload.substr(4);
    frame.length = static_cast<std::uint8_t>(data.size());
    data.resize(8);
    frame.data.bytes = data;
    return ros::encoded(frame, ros::Encoding::kCdr);
  }
  void importOf(const std::vector<std::pair<Stamp, std::string>>& messages, int code) {
    McapWriter writer(file("bus.mcap"), "ros2");
    const auto channel = writer.addChannel("/can", "cdr", {"can_msgs/msg/Frame", "ros2msg", ""});
    for (const auto& [stamp, bytes] : messages) writer.write(channel, stamp, bytes);
    writer.close();
    ASSERT_EQ(import("bag", {"--bag", file("bus.mcap")}), code) << error_;
  }
  std::vector<std::pair<Stamp, std::string>> sent_;  ///< canMessage()
  std::vector<SensorFrame> expected_;
};

TEST_F(BagCan, FramesOfAnEsrGiveTheScansOfItsDecoder) {
  ASSERT_GE(expected_.size(), 2U);
  std::vector<std::pair<Stamp, std::string>> messages;
  for (const auto& [stamp, payload] : sent_) {
    messages.emplace_back(stamp, message(stamp, payload));
    messages.emplace_back(stamp, message(stamp, canMessage(0x7FF, "other")));  // of the bus
  }
  importOf(messages, 3);  // without transforms the radar's place is not known
  const auto frames = framesOf("can");
  ASSERT_EQ(frames.size(), expected_.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& got = std::get<RadarReturns>(frames[i].data).returns;
    const auto& right = std::get<RadarReturns>(expected_[i].data).returns;
    ASSERT_EQ(got.size(), right.size());
    for (std::size_t k = 0; k < got.size(); ++k) {
      EXPECT_EQ(got[k].range, right[k].range);
      EXPECT_EQ(got[k].range_rate, right[k].range_rate);
    }
  }
}

TEST_F(BagCan, AFrameThatSaysMoreBytesThanItHasIsLeftOut) {
  std::vector<std::pair<Stamp, std::string>> messages;
  for (const auto& [stamp, payload] : sent_) messages.emplace_back(stamp, message(stamp, payload));
  ros::CanFrame wrong;
  wrong.header = {Stamp{kBusStart}, "base_link"};
  wrong.length = 9;
  wrong.data.bytes = "12345678";
  messages.insert(messages.begin(), {Stamp{kBusStart}, ros::encoded(wrong, ros::Encoding::kCdr)});
  importOf(messages, 3);
  EXPECT_EQ(framesOf("can").size(), expected_.size());
  EXPECT_NE(error_.find("/can: 1 unreadable messages left out"), std::string::npos) << error_;
  EXPECT_NE(error_.find("a CAN frame of 9 bytes, expected at most 8"), std::string::npos);
}

}  // namespace
}  // namespace perception
