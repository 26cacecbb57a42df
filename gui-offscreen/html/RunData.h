#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gui-offscreen/views/SceneView.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Errors of an object against the object of the truth that was matched to it at an instant.
struct TruthErrors {
  std::int64_t truth = -1;        ///< id of the truth
  double position = 0;            ///< [m] between the centers
  std::optional<double> speed;    ///< [m/s] estimate minus truth, if the truth has a velocity
  std::optional<double> heading;  ///< [rad] in (-pi, pi], if both have one
  bool right_class = false;       ///< the most probable class is that of the truth
};
/// By scene, by id of the object.
using RunErrors = std::vector<std::map<std::uint64_t, TruthErrors>>;

/// Data of a run as its interactive page reads them: tracks as columns by object, sensor data by
/// scene. Positions are relative to `origin`, the first ego position; lengths to 1 cm. Lidar
/// returns and occupied cells are thinned evenly to a budget of bytes, images to every n-th scene.
class RunData {
 public:
  struct Budget {
    std::size_t points = 14'000'000;  ///< [bytes of the page] for returns and cells
    std::size_t images = 5'000'000;   ///< [bytes of the page]
    std::size_t every_image = 0;      ///< images of every n-th scene; 0: as the bytes allow
  };
  static constexpr double kPointBytes = 8;            ///< of a return or a cell in the block
  static constexpr double kBase64 = 4.0 / 3 * 1.01;   ///< bytes of the page by byte, at most
  static constexpr double kCellShare = 0.2;           ///< of the budget of points
  static constexpr std::size_t kImageBytes = 70'000;  ///< of the page, about, for one image
  /// `record` names log and run; `origin`, of a run that comes scene by scene: not the first of
  /// these scenes.
  RunData(const TrackedRun& run, const RunRecord& record, const Budget& budget,
          const std::optional<Vector3>& origin = std::nullopt);
  RunData(const TrackedRun& run, const RunRecord& record) : RunData(run, record, Budget()) {}

  /// Sensor data and truth of scene `index`; scenes in ascending order, any may be left out.
  void add(std::size_t index, const SceneView& view);
  /// Truth alone, of a scene without sensor data.
  void addTruth(std::size_t index, const SceneView& view);
  /// Of the scenes of this run.
  void setErrors(const RunErrors& errors);
  std::uint64_t pointsSeen() const { return points_seen_; }
  std::uint64_t pointsKept() const { return points_kept_; }
  const nlohmann::json& collected() const { return json_; }
  const std::string& bytes() const { return points_; }      ///< binary block of returns and cells
  const nlohmann::json& images() const { return images_; }  ///< JPEGs as base64

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
