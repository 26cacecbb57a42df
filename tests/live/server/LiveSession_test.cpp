#include "libperception/live/server/LiveSession.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "tests/live/server/RawClient.h"

namespace perception::test {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kSilence = 1;  // [s]

LiveServer::Params impatient() {
  LiveServer::Params params;
  params.name = "test";
  params.limits.silence = kSilence;
  return params;
}

bool hasPagesFor(LiveServer& server, double seconds) {
  const auto until = Clock::now() + std::chrono::duration<double>(seconds);
  while (server.hasPages() && Clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return server.hasPages();
}

void waitForPage(LiveServer& server) {
  for (int i = 0; i < 500 && !server.hasPages(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(server.hasPages());
}

TEST(LiveSession, AClientThatAnswersNothingIsGone) {
  LiveServer server(impatient());
  const SocketClient silent(server.port(), kPageProtocol);
  waitForPage(server);
  EXPECT_FALSE(hasPagesFor(server, 10 * kSilence));
}

TEST(LiveSession, AClientThatTakesNoDataIsGone) {
  LiveServer server(impatient());
  const SocketClient stuck(server.port(), kPageProtocol, "", "/", 4096);
  waitForPage(server);
  server.post([&] {
    server.sendToPages("scene", std::make_shared<const std::string>(32 << 20, '.'), true);
  });
  EXPECT_FALSE(hasPagesFor(server, 10 * kSilence));
}

TEST(LiveSession, AClientThatAnswersPingsStays) {
  LiveServer server(impatient());
  SocketClient client(server.port(), kPageProtocol);
  waitForPage(server);
  const auto until = Clock::now() + std::chrono::duration<double>(3 * kSilence);
  int pings = 0;
  while (Clock::now() < until) {
    const auto frame = client.frame();
    ASSERT_TRUE(frame) << "closed after " << pings << " pings";
    ASSERT_EQ(frame->opcode, 9);
    client.send(frameOf(10, frame->payload));
    ++pings;
  }
  EXPECT_GE(pings, 2);
  EXPECT_TRUE(server.hasPages());
}

// Its answer to a ping would come after what waits before the ping.
TEST(LiveSession, AClientThatReadsSlowlyAndAnswersNothingStays) {
  LiveServer server(impatient());
  SocketClient slow(server.port(), kPageProtocol, "", "/", 4096);
  waitForPage(server);
  const auto scene = std::make_shared<const std::string>(1 << 17, '.');
  const auto until = Clock::now() + std::chrono::duration<double>(4 * kSilence);
  while (Clock::now() < until) {
    server.post([&] { server.sendToPages("scene", scene, true); });
    ASSERT_EQ(slow.read(1 << 16).size(), std::size_t{1} << 16) << "closed";
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_TRUE(server.hasPages());
}

}  // namespace
}  // namespace perception::test
