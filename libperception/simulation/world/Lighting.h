#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"

namespace perception {

/// Red, green, blue in linear units: reflectance [0, 1] of surfaces, radiance of light. A white
/// surface that faces the sun has radiance 1.
using Rgb = Vector3;

/// [light]: sun, sky, haze and exposure of rendered images (method.md 9.11). Weather may change it
/// from image to image: fog raises the haze, night takes the sun below the horizon and lowers the
/// ambient light. Defaults assumed: a clear day.
struct Lighting {
  double sun_azimuth = radians(-60);   ///< [rad] world, from x towards y
  double sun_elevation = radians(40);  ///< [rad] below 0: no sunlight
  double ambient = 0.3;   ///< light of the sky, as a share of the sun's at right angles
  double exposure = 2.0;  ///< of the camera, times the radiance
  double haze = 2e-4;     ///< [1/m] extinction: visible to 15 km (method.md 9.3)
  // Set by the weather alone (method.md 9.14):
  double exposure_time = 0.002;   ///< [s] of the shutter; KITTI's cameras at most [geiger2013]
  double gain = 1;                ///< of the sensor; above 1 its noise is seen
  double headlights = 0;          ///< [m^2] of the vehicle itself: over r^2 the light that arrives
  double headlights_azimuth = 0;  ///< [rad] world, whereto they shine

  void visit(ParamVisitor& v);
  Vector3 sunDirection() const;  ///< unit, towards the sun, world
  bool hasSun() const { return sun_elevation > 0; }
  /// Color of direct light; zero when the sun is down.
  Rgb sunlight() const;
  /// Radiance of the clear sky in a direction (unit vector, world); below the horizon that of the
  /// horizon, the color of distant objects in haze.
  Rgb sky(const Vector3& direction) const;
  /// Light that arrives on a surface from sky and ground, over pi: times reflectance, a radiance.
  Rgb ambientOn(const Vector3& normal) const;
  /// The same seen through the layer of hazy air over the ground.
  Rgb hazySky(const Vector3& direction) const;
  /// A radiance attenuated over `range` [m], with the light scattered in by the air.
  Rgb through(const Rgb& radiance, double range, const Vector3& direction) const;
  /// [m] the way of a line of sight through the layer of hazy air over the ground.
  static double airPath(const Vector3& direction);
  /// Light of the own headlights that arrives at `range` [m] in a direction from the camera (unit,
  /// world) on a surface that faces them, over pi: falls with 1/r^2 and the haze on the way there.
  double headlightsOn(const Vector3& direction, double range) const;
  /// The linear display value in [0, 1] of a radiance.
  Rgb exposed(const Rgb& radiance) const;
  /// The radiance of a linear display value; the largest below 1 stands for all above.
  Rgb radianceOf(const Rgb& linear) const;
};

/// The byte of a linear display value: the curve of sRGB (IEC 61966-2-1).
std::uint8_t displayByte(double linear);
/// The linear display value of a byte.
double linearOf(std::uint8_t byte);

}  // namespace perception
