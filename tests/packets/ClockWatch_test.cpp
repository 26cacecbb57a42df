#include "libperception/packets/ClockWatch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace perception {
namespace {

constexpr std::int64_t kStart = 1700000000000000000;  // [ns]

/// A device that sends a stamp every 10 ms.
class Device {
 public:
  /// Sends for `seconds`; each packet is received `delay` [s] after its time, in order.
  void send(double seconds, double delay = 0.001) {
    for (double end = t_ + seconds; t_ < end; t_ += 0.01) {
      DecodedPacket packet;
      packet.clock_period_ns = period_ns;
      packet.stamp_ns = Stamp{kStart}.ns + std::int64_t((t_ + clock) * 1e9);
      if (period_ns > 0) packet.stamp_ns %= period_ns;
      received_ = std::max(received_ + 1e-5, t_ + delay);
      if (const auto text = watch.add(packet, Stamp{kStart} + received_)) said.push_back(*text);
    }
  }
  /// The computer does not listen for so long: what was sent is received at its end, at once.
  void stall(double seconds) {
    received_ = t_ + seconds;
    send(seconds);
  }

  ClockWatch watch;
  std::vector<std::string> said;
  double clock = 0;            ///< [s] ahead of the computer's
  std::int64_t period_ns = 0;  ///< of stamps that begin anew

 private:
  double t_ = 0.01, received_ = 0;
};

TEST(ClockWatch, PacketsThatComeLateAreNoStep) {
  Device device;
  device.stall(1.5);
  for (int again = 0; again < 5; ++again) {
    device.send(1);
    device.stall(2.5);
  }
  EXPECT_EQ(device.watch.ledger().steps, 0U);
  EXPECT_TRUE(device.said.empty());
  device.send(2);
  EXPECT_NEAR(*device.watch.ledger().offset, 0.001, 1e-6);
}

TEST(ClockWatch, OneThatIsSetAheadIsToldAtOnceAndOneSetBackAfterASecond) {
  Device device;
  device.send(1);
  device.clock = 7;
  device.send(0.02);
  ASSERT_EQ(device.said.size(), 1U);
  EXPECT_EQ(device.said[0], "its clock was set by +7.000 s");
  device.send(1);
  device.clock = 4;
  device.send(0.9);
  EXPECT_EQ(device.said.size(), 1U);
  device.send(0.2);
  ASSERT_EQ(device.said.size(), 2U);
  EXPECT_EQ(device.said[1], "its clock was set by -3.000 s");
  EXPECT_EQ(device.watch.ledger().steps, 2U);
  EXPECT_NEAR(*device.watch.ledger().offset, 0.001 - 4, 1e-3);
}

TEST(ClockWatch, StampsThatBeginAnewEveryHourAreNoStep) {
  Device device;
  device.period_ns = 2000000000;
  device.send(9);
  EXPECT_EQ(device.watch.ledger().steps, 0U);
  EXPECT_NEAR(*device.watch.ledger().offset, 0.001, 1e-6);
}

}  // namespace
}  // namespace perception
