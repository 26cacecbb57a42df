#pragma once
#include <vector>

namespace perception {

/// A positive quantity with its central 90 % interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// Rates from the share of beams that return from the air (method.md 9.10).
class PrecipitationRate {
 public:
  PrecipitationRate();
  /// [mm/h] of rain. `near`: share of a lidar's beams that return from 1.5 to 6 m; `open`: share of
  /// beams with nothing within 24 m; `few_far`: the returns end where single drops do (method.md
  /// 9.1), so the law of drops holds, else the measured one.
  Estimate rain(double near, double open, bool few_far) const;
  /// [mm/h] of water. `near`: share of the beams that return from 1.5 to 10 m.
  Estimate snow(double near) const;

 private:
  std::vector<double> drops_;  ///< share of open beams with a drop at 1.5 to 6 m, by rate
};

/// [m] the meteorological optical range in which a surface of usual reflectivity is just received
/// from `reach` [m], method.md (57).
Estimate visibilityOfReach(double reach);

}  // namespace perception
