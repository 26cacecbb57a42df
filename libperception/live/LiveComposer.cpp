#include "libperception/live/LiveComposer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "gui-offscreen/html/RunData.h"
#include "gui-offscreen/views/SensorView.h"
#include "libperception/interop/exports/FoxgloveMessages.h"
#include "libperception/interop/exports/FoxgloveSchemas.h"

namespace perception {
namespace {

using Json = nlohmann::json;

constexpr double kLastScan = 0.5;            // [s] after which returns are too old to be shown
constexpr std::size_t kSceneBytes = 200000;  // budget of a scene: 14,800 returns, 3,700 cells
constexpr std::size_t kMostReturns = 48000;  // of a scan, before they are thinned by their height

std::string textOf(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::shared_ptr<const std::string> shared(std::string text) {
  return std::make_shared<const std::string>(std::move(text));
}

Json numberOf(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json intervalOf(const Estimate& e) {
  return {numberOf(e.value), numberOf(e.low), numberOf(e.high)};
}

double doubtedShare(const WeatherRow& row) {
  return static_cast<double>(row.trust.phantoms) /
         static_cast<double>(std::max<std::size_t>(row.trust.returns, 1));
}

const McapWriter::Schema& stateSchema() {
  static const McapWriter::Schema schema = numbersSchema(
      "perception.State",
      {"speed", "yaw_rate", "objects", "free_distance", "safe_speed", "stop", "latency"});
  return schema;
}

const McapWriter::Schema& weatherSchema() {
  static const McapWriter::Schema schema = numbersSchema(
      "perception.Weather",
      {"clear", "rain", "snow", "fog", "rain_mm_h", "snow_mm_h", "visibility", "doubted"});
  return schema;
}

}  // namespace

LiveComposer::LiveComposer(LiveServer& server, std::vector<std::string> class_names,
                           const std::string& log, const std::string& config)
    : server_(server), class_names_(std::move(class_names)), log_(log), config_(config) {}

void LiveComposer::begin() {
  server_.setGreeting(greeting());
  channel("/tracks", sceneUpdateSchema());
  channel("/tf", frameTransformSchema());
  channel("/state", stateSchema());
  channel("/events", logSchema());
}

std::string LiveComposer::greeting() const {
  TrackedRun none;
  none.class_names = class_names_;
  RunRecord record;
  record.input = log_;
  record.config = config_;
  record.simulated = simulated_;
  const Json all = RunData(none, record).collected();
  Json hello;
  for (const char* key : {"log", "config", "simulated", "classes"}) hello[key] = all.at(key);
  return textOf({{"hello", hello}});
}

void LiveComposer::compose(const LiveBatch& batch) {
  if (batch.simulated && !simulated_) {
    simulated_ = true;
    server_.setGreeting(greeting());
    server_.sendToPages("hello", shared(greeting()), false);
  }
  for (const auto& [label, frame] : batch.frames) frames_[label] = frame;
  if (batch.cells) cells_ = batch.cells;
  if (batch.scene) last_ = batch.scene->stamp;
  sendRows(batch);
  if (batch.scene) {
    if (!origin_) origin_ = batch.scene->ego.T_world_ego.translation();
    ++scenes_;
    if (server_.hasPages()) sendScene(batch);
  }
  sendFoxglove(batch);
}

SceneView LiveComposer::viewOf(const LiveBatch& batch) const {
  SceneView view;
  view.scene = *batch.scene;
  for (const auto& [label, frame] : frames_) {
    if (std::abs(view.scene.stamp - frame->stamp) > kLastScan) continue;
    addReturns(*frame, kMostReturns, view);
  }
  if (cells_) view.occupied = *cells_;
  view.corridor = batch.corridor;
  view.free = batch.free;
  return view;
}

void LiveComposer::sendScene(const LiveBatch& batch) {
  TrackedRun run;
  run.first_stamp = batch.first_stamp;
  run.class_names = class_names_;
  run.scenes = {*batch.scene};
  RunData data(run, RunRecord(), RunData::Budget{kSceneBytes, 0}, origin_);
  data.add(0, viewOf(batch));
  const Json& all = data.collected();
  Json message = {
      {"n", scenes_}, {"scene", all.at("scenes").at(0)}, {"objects", all.at("objects")}};
  if (batch.latency) message["latency"] = *batch.latency;
  std::string text = textOf(message);
  text.append((8 - (text.size() + 4) % 8) % 8, ' ');  // the block begins at a multiple of eight
  std::string bytes;
  bytes.reserve(4 + text.size() + data.bytes().size());
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(text.size() >> (8 * i) & 255);
  bytes += text;
  bytes += data.bytes();
  server_.sendToPages("scene", shared(std::move(bytes)), true);
}

void LiveComposer::sendRows(const LiveBatch& batch) {
  for (const WeatherRow& row : batch.weather) {
    const WeatherState& w = row.state;
    const Json shown = {{"sensor", row.sensor},
                        {"t", row.stamp - batch.first_stamp},
                        {"p", w.probability},
                        {"rain", intervalOf(w.rain_mm_h)},
                        {"snow", intervalOf(w.snow_mm_h)},
                        {"visibility", intervalOf(w.visibility)},
                        {"doubted", doubtedShare(row)}};
    server_.sendToPages("weather/" + row.sensor, shared(textOf({{"weather", shown}})), false);
    send("/weather/" + row.sensor, weatherSchema(), "/weather/" + row.sensor, row.stamp,
         numbersMessage(row.stamp, {{"clear", w.of(WeatherType::kClear)},
                                    {"rain", w.of(WeatherType::kRain)},
                                    {"snow", w.of(WeatherType::kSnow)},
                                    {"fog", w.of(WeatherType::kFog)},
                                    {"rain_mm_h", w.rain_mm_h.value},
                                    {"snow_mm_h", w.snow_mm_h.value},
                                    {"visibility", w.visibility.value},
                                    {"doubted", doubtedShare(row)}}));
  }
  for (const LiveBatch::Event& event : batch.events) {
    Json shown = event.content;
    const Stamp stamp = event.stamp.value_or(last_);
    send("/events", logSchema(), "", stamp,
         logMessage(stamp, shown.at("severity") == "warning", shown.at("kind"),
                    shown.at("message")));
    shown["t"] = event.stamp ? Json(*event.stamp - batch.first_stamp) : Json(nullptr);
    server_.sendToPages("", shared(textOf({{"event", shown}})), false);
  }
}

void LiveComposer::sendFoxglove(const LiveBatch& batch) {
  for (const auto& [label, frame] : batch.frames) {
    const std::string topic = "/sensors/" + label;
    const std::uint32_t id = channel(topic, pointCloudSchema());
    if (!batch.scene || batch.scene->stamp != frame->stamp)
      sendTransform(frame->ego.T_world_ego, frame->stamp, "world", "ego");
    sendTransform(frame->T_ego_sensor, frame->stamp, "ego", label);
    if (!server_.isSubscribed(id)) continue;
    const auto* cloud = std::get_if<LidarCloud>(&frame->data);
    send(topic, pointCloudSchema(), topic, frame->stamp,
         cloud != nullptr ? pointCloud(*cloud, frame->stamp, label)
                          : pointCloud(std::get<RadarReturns>(frame->data), frame->stamp, label));
  }
  if (!batch.scene || !server_.hasSubscribers()) return;
  sendTransform(batch.scene->ego.T_world_ego, batch.scene->stamp, "world", "ego");
  send("/tracks", sceneUpdateSchema(), "/tracks", batch.scene->stamp,
       wholeSceneUpdate(*batch.scene, class_names_));
  sendState(batch);
}

void LiveComposer::sendTransform(const Pose3& T, Stamp stamp, const std::string& parent,
                                 const std::string& child) {
  if (server_.isSubscribed(channel("/tf", frameTransformSchema())))
    send("/tf", frameTransformSchema(), "/tf " + child, stamp,
         frameTransform(T, stamp, parent, child));
}

void LiveComposer::sendState(const LiveBatch& batch) {
  const Scene& scene = *batch.scene;
  std::map<std::string, double> values = {{"speed", scene.ego.velocity.norm()},
                                          {"yaw_rate", scene.ego.yaw_rate},
                                          {"objects", static_cast<double>(scene.objects.size())}};
  if (scene.path) {
    values["free_distance"] = scene.path->distance;
    values["safe_speed"] = scene.path->safe_speed;
    values["stop"] = scene.path->stop ? 1 : 0;
  }
  if (batch.latency) values["latency"] = *batch.latency;
  send("/state", stateSchema(), "/state", scene.stamp, numbersMessage(scene.stamp, values));
}

std::uint32_t LiveComposer::channel(const std::string& topic, const McapWriter::Schema& schema) {
  const auto id = static_cast<std::uint32_t>(channels_.size() + 1);
  const auto [known, is_new] = channels_.emplace(topic, id);
  if (is_new) server_.addChannel({id, topic, schema});
  return known->second;
}

void LiveComposer::send(const std::string& topic, const McapWriter::Schema& schema,
                        const std::string& slot, Stamp stamp, std::string payload) {
  server_.send(channel(topic, schema), slot, stamp, shared(std::move(payload)));
}

void LiveComposer::end() {
  server_.sendToPages("", shared(textOf({{"end", {{"scenes", scenes_}}}})), false);
}

}  // namespace perception
