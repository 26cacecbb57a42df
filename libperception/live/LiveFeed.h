#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libperception/grid/SafetyGrid.h"
#include "libperception/grid/way/FreeDistance.h"
#include "libperception/live/server/LiveServer.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/phantoms/WeatherWatch.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// What is shown of a run at one instant. The tracker hands it to the server.
struct LiveBatch {
  struct Event {
    std::optional<Stamp> stamp;
    nlohmann::ordered_json content;  ///< as of EventLog::Listener
  };
  using Cells = std::shared_ptr<const std::vector<GridCell>>;

  std::optional<Scene> scene;
  Stamp first_stamp;              ///< of the log: t = 0
  std::optional<double> latency;  ///< [s] of sensors at work
  bool simulated = false;
  std::map<std::string, std::shared_ptr<const SensorFrame>> frames;  ///< new ones, newest by label
  Cells cells;  ///< occupied, near the vehicle; null: as before
  std::optional<Corridor> corridor;
  FreeDistance free;
  std::vector<WeatherRow> weather;
  std::vector<Event> events;
};

class LiveComposer;

/// Shows a run as it goes on. It is called by the tracker's thread, copies what is shown and
/// returns; messages are made on the server's thread. If that thread falls behind, a newer scene
/// replaces the one that waits. Without clients nothing is copied.
class LiveFeed final : public PipelineObserver {
 public:
  struct Facts {
    std::string log, config;  ///< file names
    std::vector<std::string> class_names;
  };
  /// The server outlives this.
  LiveFeed(LiveServer& server, const Facts& facts);
  ~LiveFeed() override;

  void onFrame(const SensorFrame& frame) override;
  void onPath(const PathAhead& path) override;
  void onWeather(const WeatherRow& row) override;
  void onEvent(std::optional<Stamp> stamp, const nlohmann::ordered_json& content);

  struct Moment {
    Stamp first_stamp;
    std::optional<double> latency;  ///< [s]
    bool simulated = false;
    const SafetyGrid* grid = nullptr;
  };
  void put(const Scene& scene, const Moment& moment);
  /// The run is over; before LiveServer::finish().
  void end();
  /// Scenes that were replaced before a message was made of them.
  std::uint64_t skipped() const { return skipped_; }

 private:
  struct Handover;
  void handOver();

  LiveServer& server_;
  std::shared_ptr<LiveComposer> composer_;  ///< of the server's thread
  std::shared_ptr<Handover> handover_;
  LiveBatch next_;                      ///< what is collected for the next scene
  std::map<std::string, bool> labels_;  ///< of frames handed over
  std::optional<std::chrono::steady_clock::time_point> cells_at_;
  std::uint64_t skipped_ = 0;
};

}  // namespace perception
