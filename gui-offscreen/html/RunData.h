#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Data of a run as its interactive page reads them: tracks as columns by object, sensor data by
/// scene. Positions are relative to `origin`, the first ego position; lengths to 1 cm. Lidar
/// returns and occupied cells are thinned evenly to a budget of bytes, images to every n-th scene.
class RunData {
 public:
  struct Budget {
    std::size_t points = 14'000'000;  ///< [bytes of the page] for returns and cells
    std::size_t images = 5'000'000;   ///< [bytes of the page]
  };
  /// `record` names log and run; `origin`, of a run that comes scene by scene: not the first of
  /// these scenes.
  RunData(const TrackedRun& run, const RunRecord& record, const Budget& budget,
          const std::optional<Vector3>& origin = std::nullopt);
  RunData(const TrackedRun& run, const RunRecord& record) : RunData(run, record, Budget()) {}

  /// Sensor data and truth of scene `index`; scenes in ascending order, any may be left out.
  void add(std::size_t index, const SceneView& view);
  /// events.jsonl, one object per event.
  void setEvents(nlohmann::json events) { json_["events"] = std::move(events); }

  /// weatherOf() of the run's folder.
  void setWeather(nlohmann::json weather) { json_["weather"] = std::move(weather); }

  /// Elements <script id="PREFIX-..."> with the data: gzip, base64. Ends the collection.
  std::string html(const std::string& prefix);

  std::uint64_t pointsSeen() const { return points_seen_; }
  std::uint64_t pointsKept() const { return points_kept_; }
  const nlohmann::json& collected() const { return json_; }
  const std::string& bytes() const { return points_; }  ///< binary block of returns and cells

 private:
  void addTracks();
  void addPoints(const SceneView& view, const Vector3& center, nlohmann::json& scene);
  void addImage(const ViewImage& image, nlohmann::json& scene);
  nlohmann::json placed(const Vector3& p) const;

  const TrackedRun& run_;
  Budget budget_;
  std::size_t points_per_scene_, cells_per_scene_, images_every_ = 1, images_bytes_ = 0;
  Vector3 origin_ = Vector3::Zero();
  nlohmann::json json_, images_ = nlohmann::json::array();
  std::string points_;
  std::uint64_t points_seen_ = 0, points_kept_ = 0;
};

/// The bytes as a gzip file, RFC 1952, without time or name.
std::string gzipped(const std::string& bytes);

}  // namespace perception
