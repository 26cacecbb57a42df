#pragma once
namespace perception {

/// The lidar receiver of the generators that look at single drops and flakes (RainDrops,
/// SnowFlakes). All beams have one divergence, and what lies nearer than the overlap of emitter and
/// receiver is not seen [kilic2021].
struct ParticleReceiver {
  double divergence = 0.003;               ///< [rad] full angle, method.md 9
  double flake_reflectivity = 0.9;         ///< at its wavelength [hahner2022], method.md 9.2
  static constexpr double kNearest = 1.5;  ///< [m] bistatic overlap [kilic2021]
  /// Weakest echo in the unit of the lidar equation: a 90 % surface at 120 m, the reach that the
  /// HDL-64E's data sheet states. The phenomena by the measured law assume 200 m.
  static constexpr double kWeakest = 0.9 / (120.0 * 120.0);

  /// [m] the beam's diameter at a range.
  double beamWidth(double range) const { return range * divergence; }
};

}  // namespace perception
