#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/lidar/description/ClusterDescriptor.h"
#include "tests/support/SyntheticCloud.h"

namespace perception::test {

/// A scanner that looks 30 deg to each side.
inline SpinningLidar narrowLidar() {
  SpinningLidar lidar;
  lidar.fov = radians(60);
  lidar.range_sigma = 0.002;
  return lidar;
}

/// The front end with its default parameters, for classes of these shapes.
inline LidarFrontEnd shapedFrontEnd(const std::vector<ObjectShape>& shapes,
                                    std::shared_ptr<const ClusterClassifier> classifier = nullptr,
                                    const LidarParams& params = {}) {
  ClassTable classes;
  for (const ObjectShape shape : shapes) {
    classes.classes.emplace_back();
    classes.classes.back().shape = shape;
  }
  return LidarFrontEnd(params, classes,
                       DetectionModel(DetectionParams{}, std::vector<ClassDetection>(shapes.size()),
                                      LidarFrontEnd::labels(params.clusters)),
                       std::move(classifier));
}

inline LidarFrontEnd plainFrontEnd() { return shapedFrontEnd({ObjectShape::kThing}); }

/// Indices of the obstacles in a region of the ego frame.
inline std::vector<std::uint32_t> obstaclesWhere(
    const LidarDetections& found, const std::function<bool(double x, double y)>& inside) {
  std::vector<std::uint32_t> members;
  for (std::size_t i = 0; i < found.x.size(); ++i)
    if (inside(static_cast<double>(found.x[i]), static_cast<double>(found.y[i])))
      members.push_back(static_cast<std::uint32_t>(i));
  return members;
}

/// Calls everything a vehicle.
inline ClusterClassifier vehiclesAlone() {
  BoostedTrees trees;
  trees.base[static_cast<std::size_t>(ClusterKind::kVehicle)] = 8;
  return {trees, std::array<Calibration, kClusterKinds>{},
          std::array<double, kClusterKinds>{0.2, 0.2, 0.2, 0.15, 0.05, 0.2}, EvidenceMemory{},
          Provenance{}};
}

/// A scan of a scene and its obstacles.
struct ObstacleScan {
  SensorFrame frame;
  LidarDetections found;

  explicit ObstacleScan(const SolidScene& scene, const SpinningLidar& lidar = narrowLidar())
      : frame(castScan(scene, lidar)), found(plainFrontEnd().detect(frame)) {
    found.field = fieldOf(DirectionCells(found.points), found.height, ObstacleParams().height_min);
  }

  LidarCloud& cloud() { return std::get<LidarCloud>(frame.data); }
  std::vector<std::uint32_t> within(double x0, double x1, double y0, double y1) const {
    return obstaclesWhere(found,
                          [&](double x, double y) { return x > x0 && x < x1 && y > y0 && y < y1; });
  }
  Descriptor describe(const std::vector<std::uint32_t>& members) {
    EXPECT_FALSE(members.empty());
    return ClusterDescriber(found, cloud(), DirectionCells(found.points)).describe(members);
  }
  Descriptor describe(double x0, double x1, double y0, double y1) {
    return describe(within(x0, x1, y0, y1));
  }
};

}  // namespace perception::test
