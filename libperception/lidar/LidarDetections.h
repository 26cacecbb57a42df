#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/description/ClusterKind.h"
#include "libperception/lidar/ground/GroundSurface.h"
#include "libperception/lidar/segments/LidarField.h"
#include "libperception/lidar/two_spacings/Clusters.h"
#include "libperception/lidar/two_spacings/PersonPeaks.h"
#include "libperception/measurement/frames/ClusterVerdicts.h"

namespace perception {

/// Least trust of a return that is hardly doubted (assumed).
inline constexpr float kHardlyDoubted = 0.95f;

/// A cluster that may be a road user.
struct JudgedCluster {
  std::vector<std::uint32_t> points;  ///< indices into the obstacles, ascending
  /// ClusterClassifier::evidence(), what speaks for road users times KnownShapes::weights().
  std::array<double, kShapes> evidence{};
  std::array<double, kRoadUsers> known{1, 1, 1};  ///< these weights
  bool alone = false;                             ///< no other return within 0.5 m
  double phantom = 0;                             ///< [0, 1] P(phantom)
  double looks_phantom = 0;                       ///< ClusterClassifier::phantomEvidence()
  double cause = 0;                               ///< [0, 1] that something makes phantoms there
};

/// Detections of one scan, in the ego frame: for the tracker, for pictures and for the safety grid.
struct LidarDetections {
  LidarDetections(EgoPoints points_, std::vector<float> height_, GroundSurface surface_)
      : points(std::move(points_)),
        top_slope(topSlope(points)),
        height(std::move(height_)),
        surface(std::move(surface_)) {}

  EgoPoints points;                      ///< usable returns
  double top_slope;                      ///< [-] tangent of the highest beam's elevation
  std::vector<float> height;             ///< [m] of each point above the local ground
  std::vector<std::uint32_t> obstacles;  ///< indices into points, in the scan's order
  std::vector<float> x, y, above;        ///< [m] position of the obstacles and height above ground
  std::vector<float> trust;              ///< [0, 1] of each obstacle; empty: all 1
  /// With a classifier: of each obstacle, see PlacedReturns::phantom.
  std::vector<float> phantom;
  std::vector<float> solid;          ///< of each of `points`, see PlacedReturns::solid
  std::vector<Cluster> clusters;     ///< car-sized; indices into the obstacles
  std::vector<PersonPeak> persons;   ///< outside of the clusters' hulls; indices into the obstacles
  std::vector<std::uint8_t> ground;  ///< per return of the frame's cloud: 1 = ground
  std::vector<JudgedCluster> judged;        ///< with a classifier, in place of clusters and persons
  std::optional<ClusterVerdicts> verdicts;  ///< with a classifier
  LidarField field;       ///< with a classifier, by azimuth in ego axes; without, the whole circle
  GroundSurface surface;  ///< the local ground
};

}  // namespace perception
