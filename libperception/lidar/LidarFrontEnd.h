#pragma once
#include <functional>
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

/// Which returns are obstacles and which are occluders: [sensor.LABEL.obstacles]. Heights are above
/// the ground.
struct ObstacleParams {
  double height_min = 0.30;   ///< [m] obstacle returns are higher than this [radecki2016]
  double height_max = 3.0;    ///< [m] and lower than this: not bridges, tree crowns (method.md 8.1)
  double min_trust = 0.1;     ///< [0, 1] returns with less trust are not obstacles (assumed)
  double occluder_min = 1.0;  ///< [m] least height of a return that occludes (assumed)
  double occluder_max = 2.2;  ///< [m] largest height of a return that occludes (assumed)
  double occluder_bin = radians(0.4);  ///< [rad] width of a bin of the occlusion map (assumed)
  /// [m] by which an occluder is nearer than what it hides (method.md 8.6).
  double occluder_margin = 0.5;

  void visit(ParamVisitor& v);
};

/// Noise of one kind of detection for the axes of FootprintModel: [sensor.LABEL.noise.NAME]. The
/// variance of an edge's bearing is sigma_bearing^2 + (sigma_edge / range)^2 (method.md 4.1). The
/// values are tuned on KITTI 0000.
struct OutlineNoise {
  double sigma_edge = 0.25;             ///< [m] of an edge, across the line of sight
  double sigma_bearing = radians(0.3);  ///< [rad] of the bearing of an edge
  double sigma_range = 0.25;            ///< [m] of the range of the nearest point

  void visit(ParamVisitor& v);
};

/// How clusters are classified: [sensor.LABEL.classifier].
struct ClassifierParams {
  /// Model file that perception-calibrate lidar-classes writes, beside the INI. If it is empty,
  /// clusters come from two spacings (method.md 8.2) and the person filter (8.3), and their size
  /// gives their class [radecki2016].
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

  /// Sets the noise of persons and unstable clusters, which is tuned on KITTI 0000.
  LidarParams();
};

/// The returns of a scan in the form that the safety grid takes. `height` [m] is that of each above
/// the ground.
PlacedReturns placedReturns(EgoPoints points, std::vector<float> height, const PointParams& point,
                            const ObstacleParams& obstacle);

/// The lidar front end. It selects obstacle returns, groups them into clusters and gives the
/// outlines of the clusters as measurements in the world frame. With a classifier the clusters are
/// segments in space, and their shape gives evidence of the class. Without one they are car-sized
/// clusters and person peaks, and their size gives the label. Labels are car_sized, person_sized
/// and, if clusters.accept_unstable is set, unstable.
class LidarFrontEnd final : public FrontEnd {
 public:
  LidarFrontEnd(const LidarParams& params, const ClassTable& classes,
                const DetectionModel& detection_model,
                std::shared_ptr<const ClusterClassifier> classifier = nullptr);

  std::vector<std::string> labelNames() const override {
    return model_->detection_model().labels();
  }
  /// What is found in one frame, in the ego frame; empty for a frame without a point cloud.
  LidarDetections detect(const SensorFrame& frame) const;

  const LidarParams& params() const { return params_; }
  /// `way` [m] is what a vehicle of that speed [m/s] has to look at from its end on: returns as far
  /// away are used, too, if it is farther than points.range_max.
  void reachAsFarAs(std::function<double(double)> way) { way_ = std::move(way); }
  /// Which returns of the frame are used.
  PointParams pointsFor(const SensorFrame& frame) const;
  static std::vector<std::string> labels(const ClusterParams& clusters);

 protected:
  Modality modality() const override { return model_->detection_model().params().modality; }
  std::shared_ptr<const MeasurementModel> model() const override { return model_; }
  void fill(const SensorFrame& frame, MeasurementScan& scan) const override;

 private:
  LidarParams params_;
  double fov_;    ///< [rad] full angle of the field of view
  double reach_;  ///< [m] largest range of the nearest point of an object
  ClassTable classes_;
  std::shared_ptr<const ClusterClassifier> classifier_;  ///< null: classes come from size
  std::shared_ptr<const FootprintModel> model_;
  std::function<double(double)> way_;  ///< empty: none
};

/// Makes the front end from the sections [sensor.LABEL], [sensor.LABEL.class.NAME] and
/// [sensor.LABEL.X], where X is points, surface, obstacles, clusters, persons, classifier and
/// noise.{car_sized, person_sized, unstable}. Throws DataError for an unreadable model file.
std::unique_ptr<FrontEnd> makeLidarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes);

}  // namespace perception
