#pragma once
#include <optional>

#include "libperception/config/ParamSet.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/ground/GroundCandidates.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Parameters of the ground plane estimator: [ground]. Values: method.md 8.1 unless a comment says
/// otherwise.
struct GroundParams {
  int sectors = 36;
  double ring = 2;               ///< [m] depth of a polar cell
  double range_min = 2.5;        ///< [m] beyond the own vehicle
  double range_max = 50;         ///< [m] beyond it, the ground seldom lies in the same plane
  double quantile = 0.10;        ///< quantile of height of a cell's candidate
  int cell_points = 5;           ///< least number of returns for a candidate
  double tolerance = 0.10;       ///< [m] of a RANSAC inlier
  int iterations = 200;          ///< of RANSAC
  double max_tilt = radians(5);  ///< [rad] relative to the ego frame
  double max_offset = 0.3;       ///< [m] at the ego origin: error of mounting height and suspension
  double min_inliers = 0.25;     ///< least share of inliers among the candidates (assumed)
  double alpha = 0.1;            ///< weight of a new plane in the exponential filter
  double wet_depth = 0.30;       ///< [m] below the plane: a mirrored return
  double wet_share = 0.05;       ///< share of mirrored returns within wet_range of a wet road
  double wet_range = 20;         ///< [m] beyond it, a change of pitch has the same effect (assumed)
  double freeze = 2;             ///< [s] for which the plane is kept on a wet road
  int max_points = 16000;        ///< of a scan used, evenly subsampled: about 20 per cell (assumed)

  void visit(ParamVisitor& v);
};

/// Estimates the ground plane from scan to scan, in the ego frame (method.md 8.1): candidates in
/// polar cells, RANSAC with counter-based draws, least squares within three sigma, a temporal
/// filter, and a test for mirror images in wet roads, which would bias the plane downward.
class GroundEstimator {
 public:
  explicit GroundEstimator(const GroundParams& params = {}, std::uint64_t seed = 0)
      : params_(params), seed_(seed) {}

  /// The plane after this scan. When no plane is found the last one is kept; before the first it is
  /// z = 0 with `measured` false.
  GroundPlane update(const SensorFrame& frame);

  /// Whether the plane was kept at the last scan because of mirrored returns.
  bool wet() const { return wet_; }
  /// Share of the last scan's returns within wet_range that lay more than wet_depth below the
  /// previous plane.
  double mirroredShare() const { return mirrored_share_; }

 private:
  double mirroredShareOf(const EgoPoints& points) const;
  std::optional<GroundPlane> fit(const GroundCandidates& candidates, const Stamp& stamp) const;

  GroundParams params_;
  std::uint64_t seed_;
  GroundPlane plane_;
  bool wet_ = false;
  bool froze_ = false;  ///< the last freeze has ended and no plane was measured since
  Stamp frozen_until_;
  double mirrored_share_ = 0;
};

}  // namespace perception
