#include "libperception/simulation/recorded/RecordedImage.h"

#include <algorithm>
#include <array>

#include "libperception/simulation/recorded/ImageRanges.h"
#include "libperception/simulation/world/Scenario.h"

namespace perception {
namespace {

constexpr double kReflectance = 0.16;  // mean of what is not the sky, as of Lighting (assumed)
constexpr double kBright = 0.9;        // of the pixels: the brightest tenth begins
constexpr double kSkyLight = 0.5;      // of that, in blue, above the horizon: sky (assumed)
constexpr double kNightSky = 0.02;     // of the light of lit streets (assumed)
constexpr double kRoadAbove = 0.2;     // [m] what is lower is lit at the road's angle

std::vector<Eigen::Vector3f> decoded(const Raster& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<Eigen::Vector3f> linear(image.pixels.size() / channels);
  std::array<float, 256> table{};
  for (std::size_t b = 0; b < table.size(); ++b)
    table[b] = static_cast<float>(linearOf(static_cast<std::uint8_t>(b)));
  for (std::size_t i = 0; i < linear.size(); ++i) {
    const std::uint8_t* pixel = &image.pixels[channels * i];
    linear[i] = channels == 3 ? Eigen::Vector3f(table[pixel[2]], table[pixel[1]], table[pixel[0]])
                              : Eigen::Vector3f::Constant(table[pixel[0]]);
  }
  return linear;
}

/// Light on what a pixel shows, as a share of the recording's.
Rgb litShare(const Lighting& light, const Vector3& direction, double range, double eye) {
  const bool sky = range >= static_cast<double>(CameraView::kSky);
  const bool road = eye + range * direction.z() < kRoadAbove;
  const double cosine = road ? -direction.z() : 1;
  if (sky) return kNightSky * light.ambient * Rgb::Ones();
  const double lamps = cosine * light.headlightsOn(direction, range);
  return light.ambient * Rgb::Ones() + Rgb::Constant(lamps);
}

double quantileOf(const std::vector<Eigen::Vector3f>& linear, int channel, double share) {
  std::vector<float> values;
  values.reserve(linear.size());
  for (const Eigen::Vector3f& value : linear) values.push_back(value(channel));
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

// Where an image shows the sky if no return tells otherwise: bright in blue.
std::vector<char> skyOf(const std::vector<Eigen::Vector3f>& linear) {
  const double least = kSkyLight * quantileOf(linear, 2, kBright);
  std::vector<char> sky;
  sky.reserve(linear.size());
  for (const Eigen::Vector3f& value : linear)
    sky.push_back(static_cast<double>(value.z()) >= least);
  return sky;
}

std::vector<float> grayOf(const Raster& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<float> gray;
  gray.reserve(image.pixels.size() / channels);
  for (std::size_t i = channels / 2; i < image.pixels.size(); i += channels)  // green
    gray.push_back(static_cast<float>(image.pixels[i]) / 255);
  return gray;
}

Raster gray(const Raster& colors) {
  Raster result{colors.width, colors.height, 1, {}};
  for (std::size_t i = 1; i < colors.pixels.size(); i += 3)
    result.pixels.push_back(colors.pixels[i]);
  return result;
}

}  // namespace

Lighting recordedLight(const std::vector<Eigen::Vector3f>& linear) {
  Lighting light;
  light.sun_elevation = radians(-1), light.haze = 0, light.ambient = 1;
  if (linear.empty()) return light;
  const std::vector<char> sky = skyOf(linear);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    if (sky[i]) continue;
    sum += light.radianceOf(linear[i].cast<double>()).y(), ++count;
  }
  const double bright = light.radianceOf(Rgb::Constant(quantileOf(linear, 1, kBright))).y();
  const double horizon = count > 0 ? std::min(bright, sum / count / kReflectance) : bright;
  light.ambient = horizon / light.sky(Vector3::UnitX()).y();
  return light;
}

// The recording's radiance stands for a reflectance in full light: how light and shade lie on its
// surfaces is not known, so that clouds change nothing but night does.
Raster throughWeather(const Raster& image, CameraView view, const std::vector<Vector3>& returns,
                      const SimulatedWeather& weather, const SensorParams& sensor,
                      const LidarCaster& caster, const RngKey& key) {
  view.linear = decoded(image);
  view.range = imageRanges(view.camera, view.T_world_camera, returns, skyOf(view.linear));
  alignRanges(view.camera, grayOf(image), view.range);
  const Lighting day = recordedLight(view.linear);
  view.light = day;
  Rng rng(key);
  weather.alter(sensor, view.light, rng);
  const bool dark = view.light.headlights > 0;
  if (!dark) view.light.ambient = day.ambient;
  const Lighting& light = view.light;
  const auto width = static_cast<std::size_t>(view.camera.width),
             height = static_cast<std::size_t>(view.camera.height);
  const double eye = view.T_world_camera.translation().z();
  if (dark || light.haze > 0) {
    caster.parallel(height, 4, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first * width; i < last * width; ++i) {
        const Vector3 direction =
            view.ray(static_cast<double>(i % width), static_cast<double>(i / width));
        const double range = view.range[i];
        Rgb radiance = day.radianceOf(view.linear[i].cast<double>());
        if (dark) radiance = radiance.cwiseProduct(litShare(light, direction, range, eye));
        const double air = std::min(range, Lighting::airPath(direction));
        view.linear[i] = light.exposed(light.through(radiance, air, direction)).cast<float>();
      }
    });
  }
  weather.alter(sensor, view, rng);
  const Raster colors = rasterOf(view);
  return image.channels == 3 ? colors : gray(colors);
}

}  // namespace perception
