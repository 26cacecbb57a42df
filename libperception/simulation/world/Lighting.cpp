#include "libperception/simulation/world/Lighting.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

// Colors assumed: a clear sky by day, of mean 1 over the hemisphere.
const Rgb kSun(1.0, 0.95, 0.86), kHorizon(1.45, 1.58, 1.72), kZenith(0.36, 0.70, 1.45);
const Rgb kSkylight(0.93, 0.98, 1.08);  // on a surface, after the camera's white balance
const Rgb kGround(0.16, 0.16, 0.14);    // mean reflectance of what lies below
constexpr double kGlow = 0.5;           // of the sky near the sun
constexpr double kLayer = 100;          // [m] height of the hazy air
constexpr double kLeastSlope = 0.01;    // of lines of sight that leave it
// Low beams (assumed): Gaussian in azimuth and, below the cut-off, in elevation; a share above it;
// nearer all is as at 2 m.
constexpr double kLampWidth = radians(20), kLampDepth = radians(15);
constexpr double kAboveCutOff = 0.03, kCutOff = radians(-0.57);
constexpr double kNearestLit = 2;     // [m]
constexpr double kBrightest = 0.998;  // linear display value: 255 of a byte and all above

}  // namespace

void Lighting::visit(ParamVisitor& v) {
  v.angle("sun_azimuth_deg", sun_azimuth, {-360, 360}, "of the sun: world, from x towards y");
  v.angle("sun_elevation_deg", sun_elevation, {-90, 90}, "of the sun; below 0: no sunlight");
  v.real("ambient", ambient, {0, 10}, "-", "light of the sky, as a share of the sun's");
  v.real("exposure", exposure, {0, 1e6}, "-", "of cameras, times the radiance");
  v.real("haze", haze, {0, 1}, "1/m", "extinction; ln 20 over it is how far one sees");
}

Vector3 Lighting::sunDirection() const {
  return {std::cos(sun_elevation) * std::cos(sun_azimuth),
          std::cos(sun_elevation) * std::sin(sun_azimuth), std::sin(sun_elevation)};
}

Rgb Lighting::sunlight() const { return hasSun() ? kSun : Rgb::Zero(); }

Rgb Lighting::sky(const Vector3& direction) const {
  const double up = std::max(0.0, direction.z());
  const double share = std::sqrt(up);  // the pale band above the horizon is narrow
  Rgb radiance = kHorizon + share * (kZenith - kHorizon);
  if (hasSun()) {
    const double near = std::max(0.0, direction.dot(sunDirection()));
    radiance += kGlow * std::pow(near, 12) * kSun;
  }
  return ambient * radiance;
}

Rgb Lighting::hazySky(const Vector3& direction) const {
  return through(sky(direction), airPath(direction), direction);
}

double Lighting::airPath(const Vector3& direction) {
  return kLayer / std::max(kLeastSlope, direction.z());
}

double Lighting::headlightsOn(const Vector3& direction, double range) const {
  if (headlights <= 0) return 0;
  const double off = wrapAngle(std::atan2(direction.y(), direction.x()) - headlights_azimuth);
  const double down = std::asin(std::clamp(direction.z(), -1.0, 1.0)) / kLampDepth;
  const double shape =
      std::exp(-.5 * off * off / (kLampWidth * kLampWidth)) *
      (direction.z() < std::sin(kCutOff) ? std::exp(-.5 * down * down) : kAboveCutOff);
  const double r = std::max(range, kNearestLit);
  return headlights * shape / (r * r) * std::exp(-haze * range);
}

Rgb Lighting::ambientOn(const Vector3& normal) const {
  const double above = .5 * (1 + normal.z());
  const Rgb from_sky = ambient * kSkylight;
  const Rgb from_ground =
      kGround.cwiseProduct(from_sky + std::max(0.0, std::sin(sun_elevation)) * sunlight());
  return above * from_sky + (1 - above) * from_ground;
}

Rgb Lighting::through(const Rgb& radiance, double range, const Vector3& direction) const {
  const double left = std::exp(-haze * range);
  const Vector3 level = Vector3(direction.x(), direction.y(), 0).normalized();
  return left * radiance + (1 - left) * sky(level);
}

Rgb Lighting::exposed(const Rgb& radiance) const {
  return {1 - std::exp(-exposure * radiance.x()), 1 - std::exp(-exposure * radiance.y()),
          1 - std::exp(-exposure * radiance.z())};
}

Rgb Lighting::radianceOf(const Rgb& linear) const {
  const Rgb v = linear.cwiseMin(kBrightest);
  return {-std::log1p(-v.x()) / exposure, -std::log1p(-v.y()) / exposure,
          -std::log1p(-v.z()) / exposure};
}

std::uint8_t displayByte(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  const double curve = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * curve));
}

double linearOf(std::uint8_t byte) {
  const double s = byte / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace perception
