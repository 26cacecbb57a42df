#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/math/Angle.h"

namespace perception {

/// The person filter of [radecki2016], a Laplacian of Gaussians over the returns (method.md 8.3):
/// [sensor.LABEL.persons].
struct PersonParams {
  enum class Kernel {
    kConsistent,  ///< second term r^4/(2 sigma^4): negative mean, as in the text of [radecki2016]
    kPrinted      ///< r^4/(2 sigma^2), as in its formula
  };

  double cell = 0.25;     ///< [m] [radecki2016]
  double sigma = 0.45;    ///< [m] [radecki2016]
  double support = 2.25;  ///< [m] radius; the kernel is below 4e-4 beyond (assumed)
  Kernel kernel = Kernel::kConsistent;
  double threshold =
      0.9;  ///< [1/m^2] normalized; an isolated person has 1.45, a wall below .5 (assumed)
  double radius = 0.45;   ///< [m] of the person's returns about the peak (= sigma)
  int min_points = 4;     ///< returns within radius (method.md 8.3)
  double min_span = 0.8;  ///< [m] lowest to highest return (method.md 8.3)
  double max_span = 2.2;  ///< [m] (method.md 8.3)
  // Bounds beyond [radecki2016], tuned on KITTI 0000 and WADS: they exclude nine in ten trunks,
  // poles and hedge corners and, of the people there, only two who touch others.
  double max_top = 2.1;     ///< [m] above ground: a tall person with a hat
  double max_bottom = 1.0;  ///< [m] above ground; what begins higher is a tree crown
  double min_width = 0.22;  ///< [m] across the line of sight; poles have .10 to .20
  int width_points = 8;     ///< least number of returns for the test of width
  double max_gap = 0.5;     ///< [m] between consecutive heights of returns, or, if larger, ...
  double gap_angle = radians(1);  ///< [rad] ... this angle seen from the sensor (sparse layers)
  // Peaks in clusters (method.md 8.3), assumed.
  double separation = 0.75;    ///< [m] radius of non-maximum suppression
  double hull_margin = 0.3;    ///< [m] about clusters in which overlaps with peaks are resolved
  double replace_share = 0.7;  ///< of a short cluster's returns in a peak: the peak replaces it
  double drop_share = 0.4;  ///< of a rider-sized cluster's returns in a peak: the peak is dropped
  double rider_size = 2.5;  ///< [m] longest side of a rider with a cycle
  double crowd_threshold = 1.2;  ///< [1/m^2] normalized; of a person close to an unstable cluster

  void visit(ParamVisitor& v);
};

/// A person-sized group of returns, separate from its neighbors, as indices into the arrays given
/// to findPersons().
struct PersonPeak {
  std::vector<std::uint32_t> points;  ///< within `radius` of the peak, in the scan's order
  Vector2 center = Vector2::Zero();   ///< [m] mean of these points
  double response = 0;                ///< of the person filter, sum over returns
  double weight = 0;                  ///< sum over the returns within radius
  double normalized = 0;              ///< response per return within radius
  float lowest = 0, highest = 0;      ///< [m] above ground
  double width = 0;  ///< [m] across the line of sight, sqrt(12) times the deviation
  double gap = 0;    ///< [m] largest between consecutive heights of returns
};

/// Peaks among obstacle points (x, y, height above ground; [m]), strongest first. `weight`: trust
/// in each return, [0, 1]; empty: all 1. Counts of returns are sums of weights.
std::vector<PersonPeak> findPersons(const std::vector<float>& x, const std::vector<float>& y,
                                    const std::vector<float>& height, const PersonParams& params,
                                    const std::vector<float>& weight = {},
                                    const Vector2& sensor = Vector2::Zero());

}  // namespace perception
