#pragma once
#include <cstdint>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Angle.h"
#include "libperception/core/Frames.h"

namespace perception {

/// The person filter of [radecki2016], a Laplacian of Gaussians over the returns (method.md 8.3):
/// [sensor.LABEL.persons].
struct PersonParams {
  enum class Kernel {
    kConsistent,  ///< second term r^4/(2 sigma^4): negative in the mean, as the text says
    kPrinted      ///< r^4/(2 sigma^2), as the formula says
  };

  double cell = 0.25;     ///< [m] [radecki2016]
  double sigma = 0.45;    ///< [m] [radecki2016]
  double support = 2.25;  ///< [m] radius; the kernel is below 4e-4 beyond (assumed)
  Kernel kernel = Kernel::kConsistent;
  double threshold =
      0.9;                ///< [1/m^2] normalized; a lone person has 1.45, a wall below .5 (assumed)
  double radius = 0.45;   ///< [m] about the peak: the person's returns (sigma)
  int min_points = 4;     ///< returns within radius (method.md 8.3)
  double min_span = 0.8;  ///< [m] lowest to highest return (method.md 8.3)
  double max_span = 2.2;  ///< [m] (method.md 8.3)
  // Bounds beyond [radecki2016], tuned on KITTI 0000 and WADS: people keep clear of them but for
  // two that touch others, and nine in ten trunks, posts and hedge corners do not.
  double max_top = 2.1;           ///< [m] above ground: a tall person with a hat
  double max_bottom = 1.0;        ///< [m] above ground: what begins higher is a crown
  double min_width = 0.22;        ///< [m] across the line of sight; posts have .10 to .20
  int width_points = 8;           ///< returns from which the width is known
  double max_gap = 0.5;           ///< [m] between heights of returns, or, if more ...
  double gap_angle = radians(1);  ///< [rad] ... that as seen from the sensor: sparse layers
  // Peaks in clusters (method.md 8.3), assumed.
  double separation = 0.75;    ///< [m] radius of non-maximum suppression
  double hull_margin = 0.3;    ///< [m] about clusters in which peaks compete with them
  double replace_share = 0.7;  ///< of a short cluster's returns in a peak: the peak replaces it
  double drop_share = 0.4;  ///< of a rider-sized cluster's returns in a peak: the peak is dropped
  double rider_size = 2.5;  ///< [m] longest side of what a rider and a cycle make
  double crowd_threshold = 1.2;  ///< [1/m^2] normalized; of a person close to something unstable

  void visit(ParamVisitor& v);
};

/// A person-sized group of returns, isolated from its neighbors. Indices are those of the arrays
/// given.
struct PersonPeak {
  std::vector<std::uint32_t> points;  ///< within `radius` of the peak, in the scan's order
  Vector2 center = Vector2::Zero();   ///< [m] mean of those
  double response = 0;                ///< of the filter, sum over returns
  double weight = 0;                  ///< of the returns within radius
  double normalized = 0;              ///< response per return within radius
  float lowest = 0, highest = 0;      ///< [m] above ground
  double width = 0;  ///< [m] across the line of sight, of an even spread with the same deviation
  double gap = 0;    ///< [m] largest between heights of returns
};

/// Peaks among obstacle points (x, y, height above ground; [m]), strongest first. `weight`: trust
/// in each return, [0, 1]; empty: all 1. Wherever returns are counted their weights are summed.
std::vector<PersonPeak> findPersons(const std::vector<float>& x, const std::vector<float>& y,
                                    const std::vector<float>& height, const PersonParams& params,
                                    const std::vector<float>& weight = {},
                                    const Vector2& sensor = Vector2::Zero());

}  // namespace perception
