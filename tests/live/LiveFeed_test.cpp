#include "libperception/live/LiveFeed.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <set>
#include <thread>

#include "tests/live/server/RawClient.h"

namespace perception::test {
namespace {

using Json = nlohmann::json;

/// What the value breaks of those parts of JSON Schema that the channels use; empty: nothing.
std::string faultAgainst(const Json& schema, const Json& value, const std::string& place = "") {
  const std::string type = schema.at("type");
  const bool fits = type == "object"    ? value.is_object()
                    : type == "array"   ? value.is_array()
                    : type == "string"  ? value.is_string()
                    : type == "boolean" ? value.is_boolean()
                    : type == "integer" ? value.is_number_integer()
                                        : type == "number" && value.is_number();
  if (!fits) return place + ": no " + type;
  if (type == "array" && schema.contains("items")) {
    for (const Json& item : value)
      if (auto fault = faultAgainst(schema["items"], item, place + "[]"); !fault.empty())
        return fault;
  }
  if (type != "object") return "";
  for (const Json& name : schema.value("required", Json::array()))
    if (!value.contains(name)) return place + ": without " + name.get<std::string>();
  const Json properties = schema.value("properties", Json::object());
  for (const auto& [name, inner] : value.items()) {
    if (!properties.contains(name)) {
      if (!properties.empty()) return place + ": " + name + " is not in the schema";
    } else if (auto fault = faultAgainst(properties[name], inner, place + "/" + name);
               !fault.empty()) {
      return fault;
    }
  }
  return "";
}

/// A run of made-up scenes that goes on.
class LiveRun {
 public:
  LiveRun() : server(params()), feed(server, {"log.rawlog", "a.ini", {"car", "static-other"}}) {}

  void step() {
    const Stamp now = first_ + 0.1 * ++step_;
    EgoState ego;
    ego.stamp = now;
    ego.T_world_ego.translation() = Vector3(5e5 + step_, 4e6, 100);
    ego.velocity = Vector2(10, 0);
    feed.onFrame(lidar(ego));
    feed.onFrame(radar(ego));
    PathAhead path;
    path.known = true;
    feed.onPath(path);
    WeatherRow row;
    row.stamp = now;
    row.sensor = "TOP";
    row.state.visibility = {1e3, 800, std::numeric_limits<double>::infinity()};
    feed.onWeather(row);
    feed.onEvent(now, {{"kind", "track_born"},
                       {"severity", "info"},
                       {"message", "car 7 \xff"},
                       {"fields", {{"id", 7}}}});
    Scene scene;
    scene.stamp = now;
    scene.ego = ego;
    SceneObject car;
    car.id = 7;
    car.class_probability = {0.9, 0.1};
    car.position = Vector3(5e5 + 20, 4e6 + 3, 100);
    car.length = 4, car.width = 2, car.height = 1.5;
    car.last_hit[Modality::kLidar] = now;
    scene.objects = {car};
    feed.put(scene, {first_, 0.034, true, nullptr});
  }

  /// Goes on by itself, until it is destroyed.
  void start() {
    stepping_ = std::thread([this] {
      while (!stop_) {
        step();
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    });
  }
  ~LiveRun() {
    stop_ = true;
    if (stepping_.joinable()) stepping_.join();
  }

  LiveServer server;
  LiveFeed feed;

 private:
  static LiveServer::Params params() {
    LiveServer::Params p;
    p.name = "log.rawlog";
    return p;
  }
  static SensorFrame lidar(const EgoState& ego) {
    SensorFrame frame;
    frame.sensor = "TOP";
    frame.stamp = ego.stamp;
    frame.ego = ego;
    LidarCloud cloud;
    for (int i = 0; i < 30000; ++i) {
      cloud.x.push_back(5.0F + 0.001F * static_cast<float>(i));
      cloud.y.push_back(1);
      cloud.z.push_back(i % 2 == 0 ? 0.0F : 2.0F);
    }
    frame.data = std::move(cloud);
    return frame;
  }
  static SensorFrame radar(const EgoState& ego) {
    SensorFrame frame;
    frame.sensor = "FRONT";
    frame.stamp = ego.stamp;
    frame.ego = ego;
    RadarReturns returns;
    returns.returns.push_back({20, 0.1, -3, true, 5, std::nullopt, -1});
    frame.data = returns;
    return frame;
  }

  const Stamp first_ = Stamp::fromSeconds(1700000000);
  int step_ = 0;
  std::atomic<bool> stop_{false};
  std::thread stepping_;
};

TEST(LiveFeed, EachChannelsMessagesKeepItsSchema) {
  LiveRun run;
  run.start();
  SocketClient client(run.server.port(), "foxglove.sdk.v1");
  client.message();  // serverInfo
  std::map<std::uint32_t, Json> schemas;
  std::map<std::uint32_t, std::string> topics;
  const auto learn = [&](const Json& text) {
    if (text.at("op") != "advertise") return;
    Json subscriptions = Json::array();
    for (const Json& c : text.at("channels")) {
      const std::uint32_t id = c.at("id");
      schemas[id] = Json::parse(c.at("schema").get<std::string>());
      EXPECT_EQ(schemas[id].at("title"), c.at("schemaName"));
      topics[id] = c.at("topic");
      subscriptions.push_back({{"id", 100 + id}, {"channelId", id}});
    }
    client.say(Json{{"op", "subscribe"}, {"subscriptions", subscriptions}}.dump());
  };
  std::set<std::string> seen;
  for (int i = 0; i < 4000 && seen.size() < 7; ++i) {
    const auto got = client.message();
    ASSERT_TRUE(got);
    if (got->opcode == 1) {
      learn(Json::parse(got->payload));
      continue;
    }
    std::uint32_t subscription = 0;
    for (int b = 4; b > 0; --b)
      subscription =
          subscription << 8 | static_cast<unsigned char>(got->payload[static_cast<std::size_t>(b)]);
    const std::uint32_t id = subscription - 100;
    const Json message = Json::parse(got->payload.substr(13));
    EXPECT_EQ(faultAgainst(schemas.at(id), message), "") << topics.at(id);
    seen.insert(topics.at(id));
  }
  EXPECT_EQ(seen, (std::set<std::string>{"/tracks", "/tf", "/state", "/events", "/weather/TOP",
                                         "/sensors/TOP", "/sensors/FRONT"}));
}

TEST(LiveFeed, TheCheckerOfSchemasFindsFaults) {
  const Json schema = {
      {"type", "object"}, {"properties", {{"a", {{"type", "integer"}}}}}, {"required", {"a"}}};
  EXPECT_EQ(faultAgainst(schema, {{"a", 1}}), "");
  EXPECT_NE(faultAgainst(schema, {{"a", 1.5}}), "");
  EXPECT_NE(faultAgainst(schema, Json::object()), "");
  EXPECT_NE(faultAgainst(schema, {{"a", 1}, {"b", 1}}), "");
}

TEST(LiveFeed, APageGetsScenesWithReturnsThinnedToTheBudget) {
  LiveRun run;
  SocketClient page(run.server.port(), kPageProtocol);
  run.start();
  const Json hello = Json::parse(page.message()->payload).at("hello");
  EXPECT_EQ(hello.at("log"), "log.rawlog");
  EXPECT_EQ(hello.at("classes").size(), 2U);
  std::set<std::string> texts;
  Json scene;
  std::string block;
  for (int i = 0; i < 1000 && (scene.is_null() || texts.size() < 2); ++i) {
    const auto got = page.message();
    ASSERT_TRUE(got);
    if (got->opcode == 1) {
      const Json text = Json::parse(got->payload);
      for (const auto& [key, value] : text.items())
        if (key != "hello") texts.insert(key);  // again once the run is known to be simulated
      continue;
    }
    std::uint32_t length = 0;
    for (int b = 3; b >= 0; --b)
      length = length << 8 | static_cast<unsigned char>(got->payload[static_cast<std::size_t>(b)]);
    EXPECT_EQ((length + 4) % 8, 0U) << "columns of 16 bits begin at even places";
    scene = Json::parse(got->payload.substr(4, length));
    block = got->payload.substr(4 + length);
  }
  EXPECT_EQ(texts, (std::set<std::string>{"weather", "event"}));
  const Json& counts = scene.at("scene").at("block");
  EXPECT_EQ(counts.at(0), 0);
  const std::size_t returns = counts.at(1), cells = counts.at(2);
  EXPECT_GT(returns, 10000U);
  EXPECT_LT(returns, 16000U);
  EXPECT_EQ(block.size(), 8 * (returns + cells));
  EXPECT_EQ(scene.at("objects").at(0).at("id"), 7);
  EXPECT_EQ(scene.at("latency"), 0.034);
  EXPECT_LT(std::abs(scene.at("scene").at("ego").at(0).get<double>()), 1e5)
      << "relative to the first scene";
  EXPECT_EQ(scene.at("scene").at("radar").size(), 1U);
  EXPECT_TRUE(scene.at("scene").contains("corridor"));
}

TEST(LiveFeed, WhereNobodyLooksOnNothingIsSent) {
  LiveRun run;
  for (int i = 0; i < 20; ++i) run.step();
  run.feed.end();
  run.server.finish();
  EXPECT_EQ(run.server.totals().sent, 0U);
  EXPECT_EQ(run.server.totals().faults, 0U);
}

}  // namespace
}  // namespace perception::test
