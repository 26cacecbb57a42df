#pragma once
#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gui-offscreen/html/RunData.h"
#include "libperception/core/system/SpoolFile.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {

/// The data of a whole run in its page: an index, and parts of kScenes scenes that the page reads
/// when it shows them. A part is a RunData; so is a scene of a live run. Where the budget does not
/// reach for kLeastReturns a scene, only every n-th scene has sensor data. Finished parts wait in a
/// file, so that memory does not grow with the run.
class RunParts {
 public:
  static constexpr std::size_t kScenes = 50;         ///< of a part: 5 s at 10 Hz
  static constexpr std::size_t kLeastReturns = 400;  ///< of a scene with sensor data
  static constexpr std::size_t kEvents = 5000;       ///< of an element

  struct Options {
    std::string prefix = "run";     ///< of the elements' names
    bool judged = false;            ///< there is a truth
    std::optional<Vector3> origin;  ///< [m]; empty: the first place of the vehicle
    RunData::Budget budget;
  };
  /// Parts wait in a file beside `output`.
  RunParts(const RunOutline& run, const RunRecord& record, const std::string& output,
           Options options);

  /// The run's next kScenes scenes, fewer at its end, and their errors, or none.
  void begin(std::vector<Scene> scenes, const RunErrors& errors = {});
  /// Whether the page has sensor data of the scene.
  bool sensed(std::size_t index) const { return index % every_ == 0; }
  /// Sensor data and truth of scene `index` of the run, in the part that was begun; in ascending
  /// order, any may be left out.
  void add(std::size_t index, SceneView view);

  /// An object of events.jsonl, in their order.
  void addEvent(nlohmann::json event);
  /// weatherOf() of the run's folder.
  void setWeather(nlohmann::json weather) { index_["weather"] = std::move(weather); }

  /// Elements <script id="PREFIX-..."> with the data: gzip, base64. Ends the collection.
  void write(const TextSink& sink);

 private:
  /// A finished part while it is packed.
  struct Packed {
    std::string name;
    std::future<std::string> text;
    std::string images;
  };
  void finish();
  void keepPacked();
  void keepEvents();
  void noteLayers(const nlohmann::json& scene);

  RunRecord record_;
  Options options_;
  std::size_t scenes_, every_ = 1, every_image_ = 1;
  nlohmann::json index_;
  TrackedRun slice_;  // scenes of the part that is collected
  std::optional<RunData> data_;
  std::size_t parts_ = 0, image_bytes_ = 0;
  std::uint64_t points_seen_ = 0, points_kept_ = 0;
  std::map<std::uint64_t, std::pair<std::size_t, std::size_t>> spans_;  // parts of each object
  std::set<std::string> layers_;
  std::optional<Packed> packed_;
  nlohmann::json events_ = nlohmann::json::array();  // not yet kept
  std::size_t event_count_ = 0;
  SpoolFile spool_;
};

}  // namespace perception
