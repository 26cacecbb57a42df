#include "libperception/measurement/objects/NewbornWidth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

constexpr std::size_t kAngles = 8;  // of the average over unknown headings
/// Shares of objects of any width, so that no class is excluded by size alone: as range times
/// angle, and across the line of sight, where two objects may be one cluster (method.md 5.14).
constexpr double kAnyWidth = 0.001, kAnyBoxWidth = 0.05;
/// Of things that lidars do not surely tell from road users: wider than 3 m is a mean share of .12
/// over seven recordings (12,332 clusters), which a thing of 1 m with that deviation hardly is.
/// Their number falls with the width: in six of them .03 to .055 of the things a meter at 3 to 4 m,
/// .017 to .04 at 4 to 5 m, .009 to .016 at 6 to 8 m and .007 to .011 beyond, as one over the width
/// does (.029, .022, .014, .011).
constexpr double kWideThings = 0.12, kWide = 3;
constexpr double kAnyNarrowWidth = 0.04;  // share of any width up to kWide (assumed)
/// Exponent of a width that the shape has told already (judged on recordings, decisions/filter.md).
constexpr double kRepeated = 0.4;

double normalDensity(double x, double variance) {
  return std::exp(-0.5 * x * x / variance) / std::sqrt(kTwoPi * variance);
}

/// Sines and cosines of evenly spaced headings from 0 to 90 degrees.
struct Headings {
  std::array<double, kAngles> sine, cosine;
  Headings() {
    for (std::size_t i = 0; i < kAngles; ++i) {
      const double angle = (static_cast<double>(i) + 0.5) * (kPi / 2) / kAngles;
      sine[i] = std::sin(angle), cosine[i] = std::cos(angle);
    }
  }
};

/// Density [1/m] of the visible width of the objects of a class, headings uniform, measured with
/// variance `noise` [m^2] (method.md 4.1).
double widthDensity(const ObjectClass& c, double width, double noise) {
  static const Headings headings;
  const double l2 = c.length_sigma * c.length_sigma, w2 = c.width_sigma * c.width_sigma;
  if (!c.motion->has_heading)
    return normalDensity(width - 0.5 * (c.length + c.width), 0.25 * (l2 + w2) + noise);
  double sum = 0;
  for (std::size_t i = 0; i < kAngles; ++i) {
    const double s = headings.sine[i], k = headings.cosine[i];
    sum += normalDensity(width - (c.length * s + c.width * k), l2 * s * s + w2 * k * k + noise);
  }
  return sum / kAngles;
}

/// [m] Mean visible width of the objects of a class.
double meanWidth(const ObjectClass& c) {
  const double share = c.motion->has_heading ? 2 / kPi : 0.5;  // of length and width
  return share * (c.length + c.width);
}

/// The same with a share of any width [m].
double widthDensity(const ObjectClass& c, double width, double noise, double share_of_any) {
  return (1 - share_of_any) * widthDensity(c, width, noise) + share_of_any / kWidestClutter;
}

}  // namespace

NewbornWidth::NewbornWidth(const ClassTable& classes, double width, double noise, bool by_shape)
    : classes_(classes), width_(width), noise_(noise), by_shape_(by_shape) {}

double NewbornWidth::density(ClassId c) const {
  const ObjectClass& own = classes_[c];
  if (!by_shape_ || own.shape != ObjectShape::kThing)
    return widthDensity(own, width_, noise_, kAnyWidth);
  const double usual = (1 - kWideThings - kAnyNarrowWidth) * widthDensity(own, width_, noise_);
  if (width_ < kWide) return usual + kAnyNarrowWidth / kWide;
  return usual +
         kWideThings / (std::log(kWidestClutter / kWide) * std::min(width_, kWidestClutter));
}

double NewbornWidth::gainInShape(ClassId c, double across) const {
  const ObjectClass& own = classes_[c];
  double by_width = 0, by_box = 0, priors = 0;
  for (const ObjectClass& other : classes_.classes) {
    if (other.shape != own.shape) continue;
    priors += other.prior;
    by_width += other.prior * widthDensity(other, width_, noise_, kAnyWidth);
    by_box += other.prior * widthDensity(other, across, noise_, kAnyBoxWidth);
  }
  if (priors <= own.prior) return 1;
  return widthDensity(own, across, noise_, kAnyBoxWidth) / by_box * by_width / density(c);
}

/// [1/m] of the classes of each shape together.
NewbornWidth::ByShape NewbornWidth::densities(ByShape& priors) const {
  ByShape sums{};
  for (ClassId c = 0; c < classes_.size(); ++c) {
    const auto shape = static_cast<std::size_t>(classes_[c].shape);
    priors[shape] += classes_[c].prior, sums[shape] += classes_[c].prior * density(c);
  }
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (priors[k] > 0) sums[k] /= priors[k];
  return sums;
}

/// [m] Mean visible width of the class that moves and is likeliest by its shape.
double NewbornWidth::widthOfLikeliest(const std::vector<double>& log_class) const {
  double most = kMinusInfinity, width = 0;
  for (ClassId c = 0; c < classes_.size(); ++c) {
    const double said = std::log(classes_[c].prior) + log_class[static_cast<std::size_t>(c)];
    if (!classes_[c].motion->moves || said <= most) continue;
    most = said, width = meanWidth(classes_[c]);
  }
  return width;
}

double NewbornWidth::gainOfShape(ClassId c, const std::vector<double>& log_class) const {
  if (log_class.size() != classes_.classes.size()) return 1;
  ByShape priors{};
  const ByShape of_shape = densities(priors);
  const double best = *std::max_element(log_class.begin(), log_class.end());
  if (width_ > widthOfLikeliest(log_class)) return 1;
  const auto gain = [&](ObjectShape shape) {
    return std::pow(of_shape[static_cast<std::size_t>(shape)], kRepeated - 1);
  };
  double before = 0, after = 0;
  for (ClassId j = 0; j < classes_.size(); ++j) {
    const ObjectShape shape = classes_[j].shape;
    const double said = classes_[j].prior *
                        std::exp(log_class[static_cast<std::size_t>(j)] - best) *
                        of_shape[static_cast<std::size_t>(shape)];
    before += said, after += said * gain(shape);
  }
  return after > 0 ? gain(classes_[c].shape) * before / after : 1;
}

}  // namespace perception
