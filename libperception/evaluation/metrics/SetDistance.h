#pragma once
#include <cstddef>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

/// GOSPA (Rahmathullah et al. 2017) with alpha = 2 and p = 2: the squared distance as sum of its
/// three parts.
struct Gospa {
  double localization = 0;  ///< [m^2] sum of squared distances of the pairs closer than the cut-off
  double missed = 0;        ///< [m^2] c^2 / 2 for each truth without estimate
  double false_ = 0;        ///< [m^2] c^2 / 2 for each estimate without truth
  std::size_t pairs = 0;

  double squared() const { return localization + missed + false_; }  ///< [m^2]
  double value() const;                                              ///< [m]
};

/// Both sets: centers on the ground [m]; cut-off c [m].
Gospa gospa(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
            double cutoff);

/// OSPA (Schuhmacher et al. 2008) with p = 2 [m]: 0 for two empty sets, the cut-off when one of
/// them is empty.
double ospa(const std::vector<Vector2>& truth, const std::vector<Vector2>& estimates,
            double cutoff);

}  // namespace perception
