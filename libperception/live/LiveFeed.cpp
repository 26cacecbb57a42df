#include "libperception/live/LiveFeed.h"

#include <mutex>
#include <utility>
#include <variant>

#include "libperception/live/LiveComposer.h"

namespace perception {
namespace {

constexpr std::chrono::milliseconds kBetweenGrids{500};
constexpr double kGridReach = 60;        // [m] around the vehicle
constexpr std::size_t kMostRows = 1000;  // of events and of weather that wait

/// What is shown of a frame; null for what is not.
std::shared_ptr<SensorFrame> copyOf(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  const auto* radar = std::get_if<RadarReturns>(&frame.data);
  if (cloud == nullptr && radar == nullptr) return nullptr;
  auto copy = std::make_shared<SensorFrame>();
  copy->sensor = frame.sensor;
  copy->stamp = frame.stamp;
  copy->ego = frame.ego;
  copy->T_ego_sensor = frame.T_ego_sensor;
  copy->ground = frame.ground;
  if (radar != nullptr) {
    copy->data = *radar;
    return copy;
  }
  LidarCloud shown;
  shown.x = cloud->x, shown.y = cloud->y, shown.z = cloud->z;
  shown.intensity = cloud->intensity;
  shown.trust = cloud->trust;
  copy->data = std::move(shown);
  return copy;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>&& from) {
  for (T& one : from) to.push_back(std::move(one));
  if (to.size() > kMostRows)
    to.erase(to.begin(), to.end() - static_cast<std::ptrdiff_t>(kMostRows));
}

}  // namespace

/// What waits for the server's thread.
struct LiveFeed::Handover {
  std::mutex mutex;
  LiveBatch batch;
  bool waits = false;
};

LiveFeed::LiveFeed(LiveServer& server, const Facts& facts)
    : server_(server),
      composer_(std::make_shared<LiveComposer>(server, facts.class_names, facts.log, facts.config)),
      handover_(std::make_shared<Handover>()) {
  server_.post([composer = composer_] { composer->begin(); });
}

LiveFeed::~LiveFeed() = default;

// The first frame of a sensor also where no client is connected: clients choose among what there
// is.
void LiveFeed::onFrame(const SensorFrame& frame) {
  const bool is_new = labels_.emplace(frame.sensor, true).second;
  if (!is_new && !server_.hasPages() && !server_.hasSubscribers()) return;
  if (auto copy = copyOf(frame)) next_.frames[frame.sensor] = std::move(copy);
}

void LiveFeed::onPath(const PathAhead& path) {
  next_.corridor.reset();
  if (!path.known) return;
  next_.corridor = path.corridor;
  next_.free = path.free;
}

void LiveFeed::onWeather(const WeatherRow& row) { append(next_.weather, {row}); }

void LiveFeed::onEvent(std::optional<Stamp> stamp, const nlohmann::ordered_json& content) {
  append(next_.events, {LiveBatch::Event{stamp, content}});
}

void LiveFeed::put(const Scene& scene, const Moment& moment) {
  next_.scene = scene;
  next_.first_stamp = moment.first_stamp;
  next_.latency = moment.latency;
  next_.simulated = moment.simulated;
  const auto now = std::chrono::steady_clock::now();
  if (moment.grid != nullptr && server_.hasPages() &&
      (!cells_at_ || now - *cells_at_ > kBetweenGrids)) {
    const Vector3 at = scene.ego.T_world_ego.translation();
    GridArea near;
    near.x_min = at.x() - kGridReach, near.x_max = at.x() + kGridReach;
    near.y_min = at.y() - kGridReach, near.y_max = at.y() + kGridReach;
    next_.cells = std::make_shared<const std::vector<GridCell>>(moment.grid->occupiedWithin(near));
    cells_at_ = now;
  }
  handOver();
}

void LiveFeed::handOver() {
  LiveBatch batch = std::exchange(next_, {});
  const std::lock_guard<std::mutex> lock(handover_->mutex);
  LiveBatch& waiting = handover_->batch;
  if (waiting.scene) ++skipped_;
  for (auto& [label, frame] : waiting.frames) batch.frames.emplace(label, std::move(frame));
  if (!batch.cells) batch.cells = std::move(waiting.cells);
  append(waiting.weather, std::move(batch.weather));
  append(waiting.events, std::move(batch.events));
  batch.weather = std::move(waiting.weather);
  batch.events = std::move(waiting.events);
  waiting = std::move(batch);
  if (handover_->waits) return;
  handover_->waits = true;
  server_.post([handover = handover_, composer = composer_] {
    LiveBatch taken;
    {
      const std::lock_guard<std::mutex> held(handover->mutex);
      taken = std::exchange(handover->batch, {});
      handover->waits = false;
    }
    composer->compose(taken);
  });
}

void LiveFeed::end() {
  if (!next_.events.empty() || !next_.weather.empty()) handOver();
  server_.post([composer = composer_] { composer->end(); });
}

}  // namespace perception
