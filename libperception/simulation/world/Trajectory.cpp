#include "libperception/simulation/world/Trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {
namespace {

constexpr double kTableStep = 0.01;  // [s]
constexpr double kRestSpeed =
    0.02;  // [m/s] speed below which the velocity does not determine a heading
constexpr double kFastest = 60;  // [m/s] faster than any road user: taken as a typing error

// Slopes that keep the cubic monotone between its values: weighted harmonic mean of the neighboring
// secants [fritsch1984]; 0 where the direction reverses.
std::vector<double> monotoneSlopes(const std::vector<double>& t, const std::vector<double>& v) {
  const std::size_t n = v.size();
  std::vector<double> slopes(n, 0.0);
  if (n < 2) return slopes;
  const auto secant = [&](std::size_t i) { return (v[i + 1] - v[i]) / (t[i + 1] - t[i]); };
  slopes.front() = secant(0);
  slopes.back() = secant(n - 2);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = secant(i - 1), after = secant(i);
    if (before * after <= 0) continue;
    const double h0 = t[i] - t[i - 1], h1 = t[i + 1] - t[i];
    slopes[i] = 3 * (h0 + h1) / ((2 * h1 + h0) / before + (h1 + 2 * h0) / after);
  }
  return slopes;
}

}  // namespace

std::string Trajectory::fault(const std::vector<double>& t, const std::vector<double>& x,
                              const std::vector<double>& y) {
  if (t.empty()) return "t, x, y: expected at least one waypoint";
  if (t.size() != x.size() || t.size() != y.size()) {
    return fmt::format("t, x, y: found {}, {} and {} values, expected as many of each", t.size(),
                       x.size(), y.size());
  }
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double dt = t[i] - t[i - 1];
    if (!(dt > 0)) {
      return fmt::format("t: found {} after {}, expected increasing times", t[i], t[i - 1]);
    }
    const double speed = std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]) / dt;
    if (!(speed <= kFastest)) {
      return fmt::format("t, x, y: {:.0f} m/s between t = {} and {} s, expected at most {} m/s",
                         speed, t[i - 1], t[i], kFastest);
    }
  }
  return "";
}

Trajectory::Trajectory(std::vector<double> t, std::vector<double> x, std::vector<double> y,
                       double heading)
    : t_(std::move(t)),
      x_(std::move(x)),
      y_(std::move(y)),
      slope_x_(monotoneSlopes(t_, x_)),
      slope_y_(monotoneSlopes(t_, y_)) {
  tabulate(heading);
}

Trajectory::Cubic Trajectory::evaluate(const std::vector<double>& values,
                                       const std::vector<double>& slopes, double t) const {
  if (t <= t_.front()) return {values.front(), t < t_.front() ? 0 : slopes.front(), 0};
  if (t >= t_.back()) return {values.back(), t > t_.back() ? 0 : slopes.back(), 0};
  const auto i =
      static_cast<std::size_t>(std::upper_bound(t_.begin(), t_.end(), t) - t_.begin()) - 1;
  const double h = t_[i + 1] - t_[i], s = (t - t_[i]) / h;
  const double rise = values[i + 1] - values[i];
  // Hermite form: value = v0 + a s + b s^2 + c s^3.
  const double a = h * slopes[i];
  const double b = 3 * rise - h * (2 * slopes[i] + slopes[i + 1]);
  const double c = h * (slopes[i] + slopes[i + 1]) - 2 * rise;
  return {values[i] + s * (a + s * (b + s * c)), (a + s * (2 * b + s * 3 * c)) / h,
          (2 * b + s * 6 * c) / (h * h)};
}

// Headings at rest are carried on from the last motion; before the first motion from the first one.
void Trajectory::tabulate(double heading) {
  const auto n = static_cast<std::size_t>(std::ceil(duration() / kTableStep)) + 1;
  heading_.assign(n, heading);
  traveled_.assign(n, 0);
  std::size_t first_motion = n;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = std::min(t_.front() + static_cast<double>(i) * kTableStep, t_.back());
    const double vx = evaluate(x_, slope_x_, t).first, vy = evaluate(y_, slope_y_, t).first;
    const double speed = std::hypot(vx, vy);
    if (i > 0) {
      heading_[i] = heading_[i - 1];
      traveled_[i] = traveled_[i - 1] + speed * kTableStep;
    }
    if (speed <= kRestSpeed) continue;
    heading_[i] = std::atan2(vy, vx);
    first_motion = std::min(first_motion, i);
  }
  if (first_motion < n) std::fill_n(heading_.begin(), first_motion, heading_[first_motion]);
}

Motion2 Trajectory::at(double t) const {
  const Cubic x = evaluate(x_, slope_x_, t), y = evaluate(y_, slope_y_, t);
  const double place =
      std::clamp((t - t_.front()) / kTableStep, 0.0, static_cast<double>(heading_.size() - 1));
  const auto i = static_cast<std::size_t>(place);
  Motion2 m;
  m.position = {x.value, y.value};
  m.velocity = {x.first, y.first};
  m.heading = heading_[i];
  m.traveled = traveled_[i];
  if (i + 1 < traveled_.size()) {
    m.traveled += (place - static_cast<double>(i)) * (traveled_[i + 1] - traveled_[i]);
  }
  const double speed = m.velocity.norm();
  if (speed > kRestSpeed) {
    m.heading = std::atan2(y.first, x.first);
    m.yaw_rate = (x.first * y.second - y.first * x.second) / (speed * speed);
  }
  return m;
}

}  // namespace perception
