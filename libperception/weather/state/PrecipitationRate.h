#pragma once
#include <vector>

namespace perception {

/// A positive quantity with its central 90 % interval.
struct Estimate {
  double value = 0, low = 0, high = 0;
};

/// What the beams of a lidar meet in the air near by.
struct AirShares {
  double drops = 0;       ///< of the beams to the open, those that return from 1.5 to 4 m
  double all = 0;         ///< of all returns, those from 1.5 to 6 m
  double flakes = 0;      ///< of the beams to the open, those that return from 1.5 to 10 m
  bool few_far = false;   ///< the returns end where single drops do
  double brightness = 0;  ///< [m] mean of intensity times range from 1.5 to 2.5 m; 0: not reported
};

/// Rates from the share of beams that return from the air, and from how bright flakes are
/// (method.md 9.10).
class PrecipitationRate {
 public:
  PrecipitationRate();
  /// [m] in which the instrument just receives a target of 90 %, by its data sheet; 0: not known.
  void setReach(double reach);
  /// [mm/h] of rain: the law of drops holds where the returns end as single drops do (method.md
  /// 9.1), else the measured one.
  Estimate rain(const AirShares& shares) const;
  /// [mm/h] of water.
  Estimate snow(const AirShares& shares) const;

 private:
  Estimate byDrops(double share) const;

  double reach_ = -1;          ///< [m] of the table
  std::vector<double> drops_;  ///< mean number of drops from 1.5 to 4 m in a beam, by rate
};

/// [m] the meteorological optical range in which a surface of usual reflectivity is just received
/// from `reach` [m], method.md (57).
Estimate visibilityOfReach(double reach);

}  // namespace perception
