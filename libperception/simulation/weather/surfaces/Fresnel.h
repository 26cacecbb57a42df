#pragma once

namespace perception {

/// Shares of light that a smooth water surface reflects, by polarization.
struct Fresnel {
  double across;  ///< s: perpendicular to the plane of incidence
  double along;   ///< p
  double mean() const { return .5 * (across + along); }
};

/// From air (1.0003) onto water (1.33); `cos_incidence` between the ray and the normal.
Fresnel waterReflectance(double cos_incidence);

/// [0, 1] share that a pane of glass (1.52) reflects at its two surfaces, polarizations averaged:
/// 2 R / (1 + R), R of one surface.
double glassReflectance(double cos_incidence);

/// Factor on the reflectivity of ground (diffuse reflectance `ground`) under a closed film of
/// water: there and back through its surface, the brighter polarization, with light that the
/// surface sends back down (method.md 9.7) [hahner2022].
double filmFactor(double ground, double cos_incidence);

/// [0, 1] share of a road that a film of this mean depth [mm] closes: 1.2 mm is all of it.
double wetShare(double film_mm);

}  // namespace perception
