#include "libperception/simulation/weather/particles/FallingParticles.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kNearestParticle = 0.3;  // [m] from the lens (assumed)
constexpr double kAperture = 0.002;       // [m] of the lens, focused on far things (assumed)
constexpr double kSharpest = 1e-3;        // [rad] what a lens resolves at best (assumed)
constexpr double kLargest = 8;            // [mm] drops break up above, method.md 9.1

/// A particle in the image: its way while the shutter is open, and its width.
struct Streak {
  Vector2 from, to;  // [px]
  double width;      // [px]
  double area;       // [px^2] of the particle itself
};

double lengthOf(const Streak& s) { return (s.to - s.from).norm(); }

// Area of what the streak covers; a pixel at least each way.
double footprint(const Streak& s) { return s.width * lengthOf(s) + kPi / 4 * s.width * s.width; }

double distance(const Streak& s, const Vector2& p) {
  const Vector2 way = s.to - s.from;
  const double squared = way.squaredNorm();
  const double along = squared > 0 ? std::clamp((p - s.from).dot(way) / squared, 0.0, 1.0) : 0;
  return (p - s.from - along * way).norm();
}

/// Places of particles in the space that a camera sees.
class Space {
 public:
  explicit Space(const CameraModel& camera) : camera_(camera) {}
  bool panorama() const { return camera_.projection == CameraModel::Projection::kEquirectangular; }
  /// Area of the space at a depth of 1 m.
  double section() const {
    if (!panorama()) return camera_.width * camera_.height / (camera_.fx * camera_.fy);
    const double half = .5 * camera_.height / camera_.fy;
    return camera_.width / camera_.fx * 2 * std::sin(std::min(half, kPi / 2));
  }
  /// A point of the section [m, camera frame] at a depth, uniform over its area.
  Vector3 place(double depth, Rng& rng) const {
    const double u = rng.uniform(-.5, camera_.width - .5), w = rng.uniform();
    if (!panorama()) {
      const double v = -.5 + w * camera_.height;
      return depth * Vector3((u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1);
    }
    const double top = std::sin(std::min(.5 * camera_.height / camera_.fy, kPi / 2));
    const double y = std::asin(top * (2 * w - 1)), x = (u - camera_.cx) / camera_.fx;
    return depth * Vector3(std::cos(y) * std::sin(x), std::sin(y), std::cos(y) * std::cos(x));
  }

 private:
  CameraModel camera_;
};

/// The image as radiance while particles are drawn into it.
class Canvas {
 public:
  explicit Canvas(CameraView& view) : view_(view), touched_(view.linear.size()) {
    radiance_.reserve(view.linear.size());
    for (const Eigen::Vector3f& value : view.linear)
      radiance_.push_back(view.light.radianceOf(value.cast<double>()).cast<float>());
  }
  void mix(std::size_t pixel, float share, const Eigen::Vector3f& radiance) {
    radiance_[pixel] += share * (radiance - radiance_[pixel]);
    touched_[pixel] = 1;
  }
  /// Back to display values; pixels without particles keep theirs.
  void expose() {
    for (std::size_t i = 0; i < radiance_.size(); ++i)
      if (touched_[i])
        view_.linear[i] = view_.light.exposed(radiance_[i].cast<double>()).cast<float>();
  }

 private:
  CameraView& view_;
  std::vector<Eigen::Vector3f> radiance_;
  std::vector<char> touched_;
};

// The share of a pixel's square that a streak covers, about.
double coverage(const Streak& s, int u, int v) {
  return std::clamp(.5 * s.width + .5 - distance(s, Vector2(u, v)), 0.0, 1.0);
}

// Whatever the pixels' grid, the shares of all pixels add up to the particle's area.
void draw(const Streak& s, double depth, const Rgb& radiance, const CameraView& view,
          Canvas& canvas) {
  const double reach = .5 * s.width + .5;
  const int left = static_cast<int>(std::floor(std::min(s.from.x(), s.to.x()) - reach)),
            right = static_cast<int>(std::ceil(std::max(s.from.x(), s.to.x()) + reach)),
            top = static_cast<int>(std::floor(std::min(s.from.y(), s.to.y()) - reach)),
            bottom = static_cast<int>(std::ceil(std::max(s.from.y(), s.to.y()) + reach));
  double sum = 0;
  for (int v = top; v <= bottom; ++v)
    for (int u = left; u <= right; ++u) sum += coverage(s, u, v);
  if (sum <= 0) return;
  const int width = view.camera.width, height = view.camera.height;
  for (int v = std::max(0, top); v <= std::min(height - 1, bottom); ++v) {
    for (int u = std::max(0, left); u <= std::min(width - 1, right); ++u) {
      const double share = coverage(s, u, v) * s.area / sum;
      const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(u);
      if (share > 0 && static_cast<double>(view.range[i]) > depth)
        canvas.mix(i, static_cast<float>(std::min(1.0, share)), radiance.cast<float>());
    }
  }
}

}  // namespace

// A particle of diameter D at depth z gives pi/4 (f D / z)^2 of the light of what it covers, a disk
// of one pixel (and kSharpest) at least, so that the smallest one that counts grows with z. With
// exponential diameters the number of those in the section at z is a Gamma(3) distribution of z: no
// shells, no reach.
std::size_t drawParticles(const FallingParticles& particles, CameraView& view, Rng& rng) {
  const Space space(view.camera);
  const double f = view.camera.fx, slope = 1000 * particles.sizes.slope;  // [1/m]
  const double per_m3 = particles.sizes.number / particles.sizes.slope;
  const double least = std::max(1.0, kSharpest * f);         // [px] width
  const double smallest = std::sqrt(kFaintest) * least / f;  // [m] at a depth of 1 m
  const double scale = 1 / (smallest * slope);               // [m]
  const int count = rng.poisson(per_m3 * space.section() * 2 * scale * scale * scale);
  const double time = view.light.exposure_time;
  const Eigen::Matrix3d to_camera = view.T_world_camera.linear().transpose();
  Canvas canvas(view);
  std::size_t drawn = 0;
  for (int k = 0; k < count; ++k) {
    const double depth =
        -scale * std::log((1 - rng.uniform()) * (1 - rng.uniform()) * (1 - rng.uniform()));
    const double diameter = smallest * depth + rng.exponential(1 / slope);
    if (depth < kNearestParticle || 1000 * diameter > kLargest) continue;
    const double side = f * diameter / depth;
    const double width = std::max(least, f * (diameter + kAperture) / depth);
    if (side * side < kFaintest * width * width) continue;
    const Vector3 place = space.place(depth, rng);
    const Vector3 falling(0, 0, -particles.fall_speed(1000 * diameter));
    const Vector3 way = time * (to_camera * (falling - view.velocity));
    const auto from = view.pixelOf(place - .5 * way), to = view.pixelOf(place + .5 * way);
    if (!from || !to) continue;
    const Streak streak{*from, *to, width, kPi / 4 * side * side};
    if (streak.area < kFaintest * footprint(streak) || lengthOf(streak) > .5 * view.camera.width)
      continue;
    const Vector3 direction = (view.T_world_camera.linear() * place).normalized();
    draw(streak, depth, particles.radiance(direction, place.norm()), view, canvas);
    ++drawn;
  }
  canvas.expose();
  return drawn;
}

}  // namespace perception
