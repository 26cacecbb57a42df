#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/lidar/BoxFit.h"
#include "libperception/lidar/Clusters.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/GroundSurface.h"
#include "libperception/lidar/PersonPeaks.h"
#include "libperception/measurement/FootprintModel.h"
#include "libperception/measurement/FrontEnd.h"

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

/// Detections of one scan, in the ego frame: for the tracker, for pictures and for the safety grid.
struct LidarDetections {
  LidarDetections(EgoPoints points_, std::vector<float> height_, GroundSurface surface_)
      : points(std::move(points_)), height(std::move(height_)), surface(std::move(surface_)) {}

  EgoPoints points;                      ///< usable returns
  std::vector<float> height;             ///< [m] of each point above the local ground
  std::vector<std::uint32_t> obstacles;  ///< indices into points, in the scan's order
  std::vector<float> x, y, above;        ///< [m] position of the obstacles and height above ground
  std::vector<float> trust;              ///< [0, 1] of each obstacle; empty: all 1
  std::vector<Cluster> clusters;         ///< car-sized; indices into the obstacles
  std::vector<PersonPeak> persons;   ///< outside of the clusters' hulls; indices into the obstacles
  std::vector<std::uint8_t> ground;  ///< per return of the frame's cloud: 1 = ground
  GroundSurface surface;             ///< the local ground
};

/// The lidar front end: obstacle returns, car-sized clusters and person peaks among them, and their
/// outlines as measurements. Labels: car_sized, person_sized and, where clusters.accept_unstable,
/// unstable.
class LidarFrontEnd final : public FrontEnd {
 public:
  LidarFrontEnd(const LidarParams& params, const ClassTable& classes,
                const DetectionModel& detection_model);

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
  double fov_;  ///< [rad]
  std::shared_ptr<const FootprintModel> model_;
};

/// Reads [sensor.LABEL], [sensor.LABEL.class.NAME], [sensor.LABEL.points], .surface, .obstacles,
/// .clusters, .persons and .noise.{car_sized, person_sized, unstable}.
std::unique_ptr<FrontEnd> makeLidarFrontEnd(Config& config, const std::string& sensor_label,
                                            const ClassTable& classes);

}  // namespace perception
