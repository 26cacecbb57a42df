#include "libperception/live/server/LiveServer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "libperception/core/Error.h"
#include "tests/live/server/RawClient.h"

namespace perception::test {
namespace {

constexpr char kFoxglove[] = "foxglove.sdk.v1";

LiveServer::Params onAnyPort() {
  LiveServer::Params params;
  params.name = "test";
  params.page = "<script nonce=\"{NONCE}\"></script>";
  return params;
}

/// Runs `work` on the server's thread and waits for it.
void onServer(LiveServer& server, const std::function<void()>& work) {
  std::promise<void> done;
  server.post([&] {
    work();
    done.set_value();
  });
  done.get_future().wait();
}

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

void waitUntil(const std::function<bool()>& fact) {
  for (int i = 0; i < 1000 && !fact(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(fact());
}

int statusOf(const std::string& answer) {
  return answer.rfind("HTTP/1.1 ", 0) == 0 ? std::stoi(answer.substr(9, 3)) : 0;
}

TEST(LiveServer, GivesThePageWithAPolicyThatAllowsItsOwnScriptAlone) {
  LiveServer server(onAnyPort());
  const std::string answer = answerTo(server.port(), getRequest(server.port(), "/"));
  EXPECT_EQ(statusOf(answer), 200);
  const std::size_t at = answer.find("script-src 'nonce-");
  ASSERT_NE(at, std::string::npos) << answer;
  const std::string nonce = answer.substr(at + 18, 32);
  EXPECT_NE(answer.find("<script nonce=\"" + nonce + "\">"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("Access-Control-Allow"), std::string::npos);
  const std::string again = answerTo(server.port(), getRequest(server.port(), "/"));
  EXPECT_EQ(again.find(nonce), std::string::npos) << "a nonce is for once";
}

TEST(LiveServer, HasNoFiles) {
  LiveServer server(onAnyPort());
  for (const char* target : {"/../../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd",
                             "/index.html", "/./", "*", "http://127.0.0.1/", "/\\..\\x", "/%00"}) {
    const std::string answer = answerTo(server.port(), getRequest(server.port(), target));
    EXPECT_EQ(statusOf(answer), 404) << target << '\n' << answer;
    EXPECT_EQ(answer.find("root:"), std::string::npos);
  }
}

TEST(LiveServer, RefusesWrongHostOriginMethodAndSubprotocol) {
  LiveServer server(onAnyPort());
  const std::uint16_t port = server.port();
  EXPECT_EQ(statusOf(answerTo(port, "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n")), 403);
  EXPECT_EQ(statusOf(answerTo(port, "GET / HTTP/1.1\r\n\r\n")), 403) << "no Host";
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/", "Host: localhost\r\n"))), 403) << "two";
  EXPECT_EQ(statusOf(answerTo(port, "POST / HTTP/1.1\r\n" + hostLine(port) + "\r\n")), 405);
  EXPECT_EQ(statusOf(answerTo(port, "POST / HTTP/1.1\r\n" + hostLine(port) +
                                        "Content-Length: 1000000000\r\n\r\n")),
            400)
      << "no body is read";
  const std::string other = "Origin: https://evil.example\r\n";
  EXPECT_EQ(statusOf(SocketClient(port, kFoxglove, other).answer), 403);
  EXPECT_EQ(statusOf(SocketClient(port, kPageProtocol, other).answer), 403);
  EXPECT_EQ(statusOf(SocketClient(port, "chat").answer), 400);
  EXPECT_TRUE(SocketClient(port, kFoxglove).isOpen());
  EXPECT_TRUE(
      SocketClient(port, kPageProtocol, "Origin: http://127.0.0.1:" + std::to_string(port) + "\r\n")
          .isOpen());
  server.finish();
  EXPECT_EQ(server.totals().refused, 8U);
}

TEST(LiveServer, WithATokenNothingIsToldWithoutIt) {
  LiveServer::Params params = onAnyPort();
  params.access.token = "0123456789abcdef";
  LiveServer server(params);
  const std::uint16_t port = server.port();
  for (const char* target : {"/", "/none", "/?token=0123456789abcdeF"})
    EXPECT_EQ(statusOf(answerTo(port, getRequest(port, target))), 401) << target;
  EXPECT_EQ(statusOf(SocketClient(port, kFoxglove).answer), 401);
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/?token=0123456789abcdef"))), 200);
  EXPECT_TRUE(SocketClient(port, kFoxglove, "", "/?token=0123456789abcdef").isOpen());
}

TEST(LiveServer, AnswersMalformedRequestsAndGoesOn) {
  LiveServer server(onAnyPort());
  const std::uint16_t port = server.port();
  EXPECT_EQ(statusOf(answerTo(port, "\x16\x03\x01\x02\r\n\r\n")), 400);
  EXPECT_EQ(statusOf(answerTo(port, "GET / HTTP/1.1\r\nno colon\r\n\r\n")), 400);
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/" + std::string(20000, 'a')))), 400);
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/",
                                               "Upgrade: websocket\r\nConnection: "
                                               "Upgrade\r\nSec-WebSocket-Version: 12\r\n"
                                               "Sec-WebSocket-Protocol: "
                                               "foxglove.sdk.v1\r\n"))),
            400)
      << "an upgrade without a key";
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/"))), 200);
}

TEST(LiveServer, BoundsItsClientsAndItsConnections) {
  LiveServer::Params params = onAnyPort();
  params.limits.clients = 2;
  params.limits.connections = 4;
  LiveServer server(params);
  const std::uint16_t port = server.port();
  SocketClient first(port, kFoxglove), second(port, kPageProtocol);
  EXPECT_TRUE(first.isOpen() && second.isOpen());
  EXPECT_EQ(statusOf(SocketClient(port, kFoxglove).answer), 503);
  EXPECT_EQ(statusOf(answerTo(port, getRequest(port, "/"))), 200);
  {
    RawClient third(port), fourth(port);
    EXPECT_EQ(answerTo(port, getRequest(port, "/")), "") << "closed without an answer";
  }
  waitUntil([&] { return statusOf(answerTo(port, getRequest(port, "/"))) == 200; });
}

TEST(LiveServer, BoundsRequestsASecond) {
  LiveServer::Params params = onAnyPort();
  params.limits.requests = 5;
  LiveServer server(params);
  int refused = 0;
  for (int i = 0; i < 12; ++i)
    if (statusOf(answerTo(server.port(), getRequest(server.port(), "/"))) == 429) ++refused;
  EXPECT_GE(refused, 1);
}

TEST(LiveServer, ARequestThatDoesNotComeIsNotWaitedForLong) {
  LiveServer::Params params = onAnyPort();
  params.limits.handshake = 0.2;
  LiveServer server(params);
  RawClient client(server.port());
  client.send("GET / HT");
  EXPECT_EQ(client.readAll(), "");
}

TEST(LiveServer, FramesThatAreWrongOrTooLongCloseTheirClientAlone) {
  LiveServer server(onAnyPort());
  const std::uint16_t port = server.port();
  SocketClient healthy(port, kFoxglove);
  healthy.message(), healthy.message();  // serverInfo, advertise
  const auto codeAfter = [&](const std::string& bytes, const char* protocol = kFoxglove) {
    SocketClient client(port, protocol);
    client.send(bytes);
    for (auto got = client.message(); got; got = client.message())
      if (got->opcode == 8) return got->code();
    return 0;
  };
  EXPECT_EQ(codeAfter(frameOf(1, "{}", false)), 1002) << "not masked";
  EXPECT_EQ(codeAfter(frameOf(3, "{}")), 1002) << "no such opcode";
  EXPECT_EQ(codeAfter(frameOf(1, "", true, 1ULL << 30)), 1009) << "a gigabyte";
  EXPECT_EQ(codeAfter(frameOf(1, "\xff\xfe")), 1007) << "no UTF-8";
  EXPECT_EQ(codeAfter(frameOf(2, "\x01")), 1003) << "binary";
  EXPECT_EQ(codeAfter(frameOf(1, "{}"), kPageProtocol), 1008) << "pages send nothing";
  std::string many;
  for (int i = 0; i < 200; ++i) many += frameOf(1, "{}");
  EXPECT_EQ(codeAfter(many), 1008) << "too many messages";
  healthy.say(R"({"op":"setParameters"})");
  const auto status = healthy.message();
  ASSERT_TRUE(status);
  EXPECT_EQ(nlohmann::json::parse(status->payload).at("level"), 2);
}

TEST(LiveServer, SendsWhatIsSubscribedAndNothingElse) {
  LiveServer server(onAnyPort());
  onServer(server, [&] {
    server.addChannel({1, "/a", {"A", "jsonschema", "{}"}});
    server.addChannel({2, "/b", {"B", "jsonschema", "{}"}});
  });
  SocketClient client(server.port(), "foxglove.websocket.v1");
  EXPECT_NE(client.answer.find("foxglove.websocket.v1"), std::string::npos);
  const auto info = nlohmann::json::parse(client.message()->payload);
  EXPECT_EQ(info.at("op"), "serverInfo");
  EXPECT_EQ(info.at("capabilities"), nlohmann::json::array());
  EXPECT_EQ(nlohmann::json::parse(client.message()->payload).at("channels").size(), 2U);
  EXPECT_FALSE(server.hasSubscribers());
  client.say(R"({"op":"subscribe","subscriptions":[{"id":9,"channelId":2}]})");
  waitUntil([&] { return server.hasSubscribers(); });
  onServer(server, [&] {
    EXPECT_FALSE(server.isSubscribed(1));
    server.send(1, "", {5}, shared("no"));
    server.send(2, "", {6}, shared("yes"));
    server.addChannel({3, "/c", {"C", "jsonschema", "{}"}});
  });
  EXPECT_EQ(client.message()->payload, foxglove::messageHead(9, {6}) + "yes");
  EXPECT_EQ(nlohmann::json::parse(client.message()->payload).at("channels").at(0).at("id"), 3);
  client.say(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":77}]})");
  EXPECT_EQ(nlohmann::json::parse(client.message()->payload).at("op"), "status");
  client.say(R"({"op":"unsubscribe","subscriptionIds":[9]})");
  waitUntil([&] { return !server.hasSubscribers(); });
}

TEST(LiveServer, ASlowReaderGetsTheNewestAndHoldsUpNobody) {
  LiveServer server(onAnyPort());
  onServer(server, [&] { server.setGreeting("hello"); });
  SocketClient slow(server.port(), kPageProtocol, "", "/", 4096);
  SocketClient quick(server.port(), kPageProtocol);
  for (SocketClient* client : {&slow, &quick}) {  // both are known to the server by now
    const auto greeting = client->message();
    ASSERT_TRUE(greeting);
    EXPECT_EQ(greeting->payload, "hello");
  }
  constexpr int kScenes = 40;
  const auto scene = [](int n) {
    return shared(std::to_string(n) + ' ' + std::string(1 << 20, '.'));
  };
  const auto numberIn = [](const std::string& text) { return std::stoi(text.substr(0, 8)); };
  for (int n = 0; n < kScenes; ++n) {
    onServer(server, [&] { server.sendToPages("scene", scene(n), true); });
    const auto message = quick.message();
    ASSERT_TRUE(message);
    EXPECT_EQ(numberIn(message->payload), n) << "in step, while the other reads nothing";
  }
  int last = -1, got = 0;
  while (last < kScenes - 1) {
    const auto message = slow.message();
    ASSERT_TRUE(message);
    EXPECT_GT(numberIn(message->payload), last);
    last = numberIn(message->payload);
    ++got;
  }
  EXPECT_LT(got, kScenes / 2);
  server.finish();
  EXPECT_EQ(server.totals().dropped, static_cast<std::uint64_t>(kScenes - got));
}

TEST(LiveServer, EndsThoughAClientReadsNothing) {
  auto server = std::make_unique<LiveServer>(onAnyPort());
  SocketClient stuck(server->port(), kPageProtocol, "", "/", 4096);
  waitUntil([&] { return server->hasPages(); });
  onServer(*server, [&] { server->sendToPages("", shared(std::string(32 << 20, '.')), true); });
  const auto begin = std::chrono::steady_clock::now();
  server.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(LiveServer, ClientsAreToldThatTheRunHasEnded) {
  LiveServer server(onAnyPort());
  SocketClient client(server.port(), kPageProtocol);
  waitUntil([&] { return server.hasPages(); });
  onServer(server, [&] { server.sendToPages("", shared("last"), false); });
  std::thread finishing([&] { server.finish(); });
  EXPECT_EQ(client.message()->payload, "last");
  EXPECT_EQ(client.message()->code(), 1001);
  client.send(frameOf(8, std::string("\x03\xe9", 2)));
  finishing.join();
}

TEST(LiveServer, APortThatIsTakenIsSaid) {
  LiveServer server(onAnyPort());
  LiveServer::Params params = onAnyPort();
  params.port = server.port();
  try {
    LiveServer second(params);
    FAIL() << "two servers on one port";
  } catch (const Error& fault) {
    EXPECT_EQ(fault.code(), ExitCode::kUnavailable);
    EXPECT_NE(std::string(fault.what()).find(std::to_string(server.port())), std::string::npos);
  }
}

}  // namespace
}  // namespace perception::test
