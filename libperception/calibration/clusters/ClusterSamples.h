#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/calibration/clusters/PointLabels.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/description/ClusterKind.h"
#include "libperception/lidar/description/DescribedClusters.h"
#include "libperception/pipeline/Pipeline.h"

namespace perception {

/// A described cluster of a scan and what the truth says of it.
struct ClusterSample {
  std::size_t log = 0;
  std::int64_t frame = -1;
  double t = 0;                     ///< [s] of the log
  std::optional<ClusterKind> kind;  ///< empty: the truth does not tell
  /// Id of the true object that it is of; of things that stood where it stands in the scan before,
  /// negative.
  std::int64_t object = kNoObject;
  static constexpr std::int64_t kNoObject = -1;
  Vector2 place = Vector2::Zero();  ///< [m] middle of its returns, ego frame
  EvidenceView view;                ///< from where it was seen
  int whole = -1;                   ///< index of the sample that it is a part of
  Descriptor descriptor{};
};

/// A true road user at one scan and the cluster, part or whole, that shows it best.
struct ObjectView {
  std::size_t log = 0;
  std::int64_t frame = -1, object = -1;
  ClusterKind kind = ClusterKind::kVehicle;
  double range = 0;         ///< [m]
  std::size_t returns = 0;  ///< obstacle returns on it
  /// Index of the sample with the greatest overlap of returns (intersection over union); -1: none.
  int sample = -1;
  double overlap = 0;  ///< [0, 1]
};

struct ClusterSamples {
  std::vector<ClusterSample> clusters;
  std::vector<ObjectView> objects;
};

/// Kind of a truth type (KITTI's words); empty: the type has no kind, such as an animal, a trailer.
std::optional<ClusterKind> kindOfTruth(const std::string& type);

/// Rules by which truth boxes name clusters.
struct SampleRules {
  double range = 45;        ///< [m] of clusters and objects
  double fov = kTwoPi;      ///< [rad] full angle ahead in which the truth is complete
  double box_margin = 0.2;  ///< [m] by which boxes are grown
  double mostly = 0.6;      ///< share of a cluster's returns on the object that names it
  double hardly = 0.1;      ///< of a thing's returns on road users at most
  double grown = 0.4;       ///< of an object's returns in a cluster of several: it is mixed
  double fragment = 0.2;    ///< of an object's returns at most in a fragment of it
};

/// Collects the samples of a log as it passes the pipeline, from frames of lidars with truth
/// (method.md 8.10).
class ClusterSampler final : public PipelineObserver {
 public:
  /// `front_end` names the obstacles of the frames of `sensor`. Borrows all but the rules.
  ClusterSampler(std::string sensor, const LidarFrontEnd& front_end, const GroundTruth& truth,
                 const PointLabels& labels, std::size_t log, const SampleRules& rules,
                 ClusterSamples& samples);
  void onFrame(const SensorFrame& frame) override;

 private:
  void addByBoxes(const SensorFrame& frame, const LidarDetections& found,
                  const GroundTruth::Instant& instant, std::size_t first);
  void addByLabels(const LidarDetections& found, const std::vector<std::uint16_t>& labels,
                   std::size_t first);

  void nameThings(const SensorFrame& frame, std::size_t first);

  std::string sensor_;
  const LidarFrontEnd& front_end_;
  const GroundTruth& truth_;
  const PointLabels& labels_;
  std::size_t log_;
  SampleRules rules_;
  ClusterSamples& samples_;
  std::optional<Stamp> first_;
  std::vector<std::vector<std::uint32_t>> points_;        ///< of the frame's clusters
  std::vector<std::pair<Vector2, std::int64_t>> things_;  ///< of the last frame: world [m], id
  std::int64_t next_thing_ = -2;
};

}  // namespace perception
