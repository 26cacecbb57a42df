#pragma once
#include <optional>

#include "libperception/config/ParamSet.h"
#include "libperception/lidar/EgoPoints.h"
#include "libperception/lidar/GroundCandidates.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// How the ground plane is found: [ground]. Values of method.md 8.1 unless said otherwise.
struct GroundParams {
  int sectors = 36;
  double ring = 2;               ///< [m] depth of a polar cell
  double range_min = 2.5;        ///< [m] clear of the own body
  double range_max = 50;         ///< [m] beyond, the ground seldom lies in the same plane
  double quantile = 0.10;        ///< height of a cell's candidate among its returns
  int cell_points = 5;           ///< fewer returns give no candidate
  double tolerance = 0.10;       ///< [m] of a RANSAC inlier
  int iterations = 200;          ///< of RANSAC
  double max_tilt = radians(5);  ///< [rad] against the ego frame
  double max_offset = 0.3;       ///< [m] at the ego origin: error of mounting height and suspension
  double min_inliers = 0.25;     ///< share of candidates below which there is no plane (assumed)
  double alpha = 0.1;            ///< weight of a new plane against the last
  double wet_depth = 0.30;       ///< [m] below the plane: a mirrored return
  double wet_share = 0.05;  ///< mirrored share of returns within wet_range that tells a wet road
  double wet_range = 20;    ///< [m] beyond, a change of pitch looks the same (assumed)
  double freeze = 2;        ///< [s] for which a wet road holds the plane
  int max_points = 16000;   ///< of a scan used, evenly taken: some 20 a cell (assumed)

  void visit(ParamVisitor& v);
};

/// Estimates the ground plane from scan to scan, in the ego frame (method.md 8.1): candidates in
/// polar cells, RANSAC with counter-based draws, least squares within three sigma, a temporal
/// filter, and a guard against mirror images in wet roads, which pull planes down.
class GroundEstimator {
 public:
  explicit GroundEstimator(const GroundParams& params = {}, std::uint64_t seed = 0)
      : params_(params), seed_(seed) {}

  /// The plane after this scan. A scan without a plane keeps the last one; before the first there
  /// is the flat default, with `measured` false.
  GroundPlane update(const SensorFrame& frame);

  /// Whether the last scan lay within a freeze after mirrored returns.
  bool wet() const { return wet_; }
  /// Share of the last scan's returns within wet_range that lay wet_depth below the predicted
  /// plane.
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
