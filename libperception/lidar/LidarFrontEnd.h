#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/LidarDetections.h"
#include "libperception/lidar/classification/ClusterClassifier.h"
#include "libperception/lidar/ground/GroundSurface.h"
#include "libperception/lidar/outline/BoxFit.h"
#include "libperception/lidar/two_spacings/Clusters.h"
#include "libperception/lidar/two_spacings/PersonPeaks.h"
#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/measurement/models/FootprintModel.h"

namespace perception {

/// Selection of obstacle returns and of occluders: [sensor.LABEL.obstacles].
struct ObstacleParams {
  double height_min = 0.30;   ///< [m] above ground [radecki2016]
  double height_max = 3.0;    ///< [m] above ground; higher: bridges, tree crowns (method.md 8.1)
  double min_trust = 0.1;     ///< [0, 1] less trusted returns are no obstacles (assumed)
  double occluder_min = 1.0;  ///< [m] above ground: least height of an occluder (assumed)
  double occluder_max = 2.2;  ///< [m] higher returns do not occlude (assumed)
  double occluder_bin = radians(0.4);  ///< [rad] of the occlusion map (assumed)
  double occluder_margin = 0.5;        ///< [m] an occluder is nearer by this much (method.md 8.6)

  void visit(ParamVisitor& v);
};

/// Noise of one kind of detection, for FootprintModel's axes: [sensor.LABEL.noise.NAME]. The
/// variance of an edge's bearing is sigma_bearing^2 + (sigma_edge / range)^2 (method.md 4.1). Tuned
/// on KITTI 0000.
struct OutlineNoise {
  double sigma_edge = 0.25;             ///< [m] across the line of sight
  double sigma_bearing = radians(0.3);  ///< [rad]
  double sigma_range = 0.25;            ///< [m] of the nearest point

  void visit(ParamVisitor& v);
};

/// [sensor.LABEL.classifier]
struct ClassifierParams {
  /// Model file of perception-calibrate lidar-classes, beside the INI. Empty: clusters come from
  /// two spacings and the person filter, and are classified by their size [radecki2016].
  std::string file;

  void visit(ParamVisitor& v);
};

/// All constants of the lidar front end.
struct LidarParams {
  PointParams points;
  SurfaceParams surface;
  ObstacleParams obstacles;
  ClusterParams clusters;
  PersonParams persons;
  BoxParams boxes;
  OutlineNoise car_noise, person_noise, unstable_noise;

  /// Noise of persons and unstable clusters, tuned on KITTI 0000.
  LidarParams();
};

/// The returns of a scan as the safety grid takes them; `height` [m] of each above the ground.
PlacedReturns placedReturns(EgoPoints points, std::vector<float> height, const PointParams& point,
                            const ObstacleParams& obstacle);

/// The lidar front end: obstacle returns, clusters among them and their outlines as measurements.
/// With a classifier, segments in space with evidence of the class by their shape; without,
/// car-sized clusters and person peaks with labels by their size. Labels: car_sized, person_sized
/// and, where clusters.accept_unstable, unstable.
class LidarFrontEnd final : public FrontEnd {
 public:
  LidarFrontEnd(const LidarParams& params, const ClassTable& classes,
                const DetectionModel& detection_model,
                std::shared_ptr<const ClusterClassifier> classifier = nullptr);

  std::vector<std::string> labelNames() const override {
    return model_->detection_model().labels();
  }
  /// Empty for a frame without a point cloud.
  LidarDetections detect(const SensorFrame& frame) const;

  const LidarParams& params() const { return params_; }
  static std::vector<std::string> labels(const ClusterParams& clusters);

 protected:
  Modality modality() const override { return model_->detection_model().params().modality; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  LidarParams params_;
  double fov_;    ///< [rad]
  double reach_;  ///< [m] of the nearest point of an object
  ClassTable classes_;
  std::shared_ptr<const ClusterClassifier> classifier_;  ///< null: by size
  std::shared_ptr<const FootprintModel> model_;
};

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME], [sensor.LABEL.points], .surface, .obstacles,
/// .clusters, .persons, .classifier and .noise.{car_sized, person_sized, unstable}.
std::unique_ptr<FrontEnd> makeLidarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes);

}  // namespace perception
