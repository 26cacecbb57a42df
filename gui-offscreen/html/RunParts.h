#pragma once
#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gui-offscreen/html/RunData.h"

namespace perception {

/// The data of a whole run in its page: an index, and parts of kScenes scenes that the page reads
/// when it shows them. A part is a RunData; so is a scene of a live run. Where the budget does not
/// reach for kLeastReturns a scene, only every n-th scene has sensor data.
class RunParts {
 public:
  static constexpr std::size_t kScenes = 50;         ///< of a part: 5 s at 10 Hz
  static constexpr std::size_t kLeastReturns = 400;  ///< of a scene with sensor data

  /// `errors` may be null: the run has no truth. `origin`: null: the first place of the vehicle.
  RunParts(const TrackedRun& run, const RunRecord& record, const RunErrors* errors = nullptr,
           const std::optional<Vector3>& origin = std::nullopt,
           const RunData::Budget& budget = RunData::Budget());

  /// Whether the page has sensor data of the scene.
  bool sensed(std::size_t index) const { return index % every_ == 0; }
  /// Sensor data and truth of scene `index`; scenes in ascending order, any may be left out.
  void add(std::size_t index, SceneView view);

  /// events.jsonl, one object per event.
  void setEvents(nlohmann::json events) { index_["events"] = std::move(events); }
  /// weatherOf() of the run's folder.
  void setWeather(nlohmann::json weather) { index_["weather"] = std::move(weather); }

  /// Elements <script id="PREFIX-..."> with the data: gzip, base64. Ends the collection.
  std::string html(const std::string& prefix);

 private:
  void begin(std::size_t part);
  void finish();
  void noteLayers(const nlohmann::json& scene);

  const TrackedRun& run_;
  RunRecord record_;
  const RunErrors* errors_;
  RunData::Budget budget_;
  Vector3 origin_ = Vector3::Zero();
  std::size_t every_ = 1, every_image_ = 1;
  nlohmann::json index_;
  TrackedRun slice_;  // scenes of the part that is collected
  std::optional<RunData> data_;
  std::size_t part_ = 0, image_bytes_ = 0;
  std::uint64_t points_seen_ = 0, points_kept_ = 0;
  std::map<std::uint64_t, std::pair<std::size_t, std::size_t>> spans_;  // parts of each object
  std::set<std::string> layers_;
  std::future<std::string> packed_;  // of the part before
  std::vector<std::string> texts_, images_;
};

}  // namespace perception
