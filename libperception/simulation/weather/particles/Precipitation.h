#pragma once
#include "libperception/core/math/Random.h"

namespace perception {

/// Diameters of falling drops or flakes: N(D) = number exp(-slope D), per m^3 of air and mm.
struct SizeDistribution {
  double number;  ///< [1/(m^3 mm)]
  double slope;   ///< [1/mm]
};
SizeDistribution marshallPalmer(double rain_mm_h);  ///< rain [marshall1948], method.md 9.1
SizeDistribution gunnMarshall(double snow_mm_h);    ///< snow [gunn1958], method.md 9.2

/// Snow by the diameters of the flakes themselves: [gunn1958] is of the drops that they melt to; of
/// a tenth of water's density a flake is 2.15 times as large (method.md 9.2, 9.14).
SizeDistribution flakeSizes(double snow_mm_h);
/// [m/s] at which a drop of a diameter [mm] falls [atlas1973].
double dropSpeed(double diameter);
inline constexpr double kFlakeDensity = 0.1;  ///< [g/cm^3] method.md 9.2
inline constexpr double kFlakeSpeed = 1;      ///< [m/s] at which flakes fall, method.md 9.2

/// [1/m] of light: pi/4 Q integral of D^2 N(D), Q the extinction efficiency of a sphere.
double extinction(const SizeDistribution& sizes, double efficiency);
double rainExtinction(double rain_mm_h);  ///< [1/m] method.md (58)
double snowExtinction(double snow_mm_h);  ///< [1/m] method.md 9.2

/// [dB/km] of a 77 GHz radar, one way: k R^a [itu2005], method.md 9.8.
double radarAttenuation(double rain_mm_h);

/// [1/m] backscatter cross section of a volume of rain at 77 GHz, method.md (62).
double radarBackscatter(double rain_mm_h);

/// Drops or flakes of one beam whose echo a lidar detects before the open sky, by their sizes and
/// the lidar equation (method.md 9.2): diameter D at range r sends back the share
/// (D / (divergence r))^2 of a target of 90 %, which (57) detects up to reference_range.
struct DetectableParticles {
  double mean = 0;   ///< number in a beam, Poisson
  double scale = 0;  ///< [m] their ranges have a Maxwell distribution of this scale

  DetectableParticles() = default;
  DetectableParticles(const SizeDistribution& sizes, double divergence, double reference_range);
  double range(Rng& rng) const;  ///< [m] draws one
};

/// Returns of a lidar's beam from drops or flakes, as measured with a VLP-16 [linnhoff2022]
/// (method.md 9.1, 9.2).
struct FalseReturnLaw {
  double per_mm_h;   ///< chance of a beam at 1 mm/h, proportional to the rate
  double log_mean;   ///< of the range [m], log-normal
  double log_sigma;  ///< of the range

  double chance(double mm_h) const;
  double range(Rng& rng) const;        ///< [m] draws one
  double shareWithin(double m) const;  ///< of the returns nearer than m
};
inline constexpr FalseReturnLaw kRainReturns = {1.69e-4, 1.362, 0.784},
                                kSnowReturns = {0.01569, 1.433, 0.787};

}  // namespace perception
