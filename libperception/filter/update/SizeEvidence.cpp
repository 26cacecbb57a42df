#include "libperception/filter/update/SizeEvidence.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

/// Returns lie within the object, so an estimate has a bias of its own [m].
constexpr double kHeightBias = 0.2, kSideBias = 0.3;
/// Lower bound of the variance [m^2], since errors of repeated sides of one object are correlated.
constexpr double kSideFloor = 0.1 * 0.1;
/// Share of objects of any size (two cars merged, half a car), so that no size excludes a class.
constexpr double kShareOfAnySize = 0.05;
constexpr double kLargest = 15;  // [m] of those
/// Share of clusters that show a part of their object: of 546 on labeled vehicles within 40 m 0.19
/// are lower than two thirds of it (five recordings).
constexpr double kShareOfParts = 0.2;
constexpr double kTallest = 4, kWidest = 4;  // [m] of those, which have any size up to that
/// Share of headings that are across, of what has hardly been seen, and of clusters that hold more
/// than their vehicle (assumed).
constexpr double kShareAcross = 0.1, kShareOfTwo = 0.05;
constexpr double kMostSigmas = 4;  // by which vehicles are longer than the mean of their class
/// What is longer than two cars is two in one cluster, or a truck. Of 411 clusters on labeled
/// vehicles (six recordings) 5 hold the middle of two, and of 567 cars and vans (KITTI's tracking
/// labels) 31 are higher than 2 m: so the share of two of which one is that high is 5/411 * 2 *
/// 31/567.
constexpr double kHigh = 2, kShareOfTwoHigh = 0.0013;
/// Evidence of a likely vehicle: with one in ten clusters, as likely as not.
constexpr double kLikelyVehicle = 2;
/// A side measures length or width if it is this close to parallel or perpendicular to the axis.
constexpr double kAlong = radians(30);

double logScaledNormal(double d, double variance) {
  return -0.5 * (d * d / variance + std::log(variance));
}

/// Without the constant factor of a normal density.
double logHeight(const ObjectClass& c, const ScalarEstimate& height) {
  return logScaledNormal(height.mean - c.height, c.height_sigma * c.height_sigma +
                                                     kHeightBias * kHeightBias + height.variance);
}

double logSide(const ScalarEstimate& side, double mean, double sigma) {
  const double variance = sigma * sigma + kSideBias * kSideBias + side.variance;
  const double density = std::exp(logScaledNormal(side.mean - mean, variance)) / std::sqrt(kTwoPi);
  return std::log((1 - kShareOfAnySize) * density + kShareOfAnySize / kLargest);
}

double logSides(const ObjectClass& c, const ScalarEstimate& length, const ScalarEstimate& width) {
  return logSide(length, c.length, c.length_sigma) + logSide(width, c.width, c.width_sigma);
}

/// Of the sides between classes of one shape.
double logFittingSides(const ObjectClass& c, const Track& track) {
  const bool too_long = track.longest > c.length + kMostSigmas * c.length_sigma;
  return logSides(c, track.fitting_length, track.fitting_width) +
         (too_long ? std::log(kShareOfTwo) : 0);
}

/// Log density of a size that may be that of a part, by those of whole objects; `any`: density of
/// parts. A part says nothing between classes of one shape: they keep the ratio of whole objects,
/// by `fitting`.
template <class Whole, class Fitting>
double logPart(const ClassTable& classes, const ObjectClass& c, double any, const Whole& whole,
               const Fitting& fitting) {
  double likeliest = whole(c), best = fitting(c);
  for (const ObjectClass& other : classes.classes) {
    if (other.shape != c.shape) continue;
    likeliest = std::max(likeliest, whole(other));
    best = std::max(best, fitting(other));
  }
  return fitting(c) - best + likeliest +
         std::log(1 - kShareOfParts + kShareOfParts * any * std::exp(-likeliest));
}

/// Complete sides as estimates of length and width.
struct CompleteSides {
  std::optional<ScalarEstimate> length, width;

  CompleteSides(const PartialBox& sides, bool a_is_length, double default_sigma) {
    const auto estimate = [&](double size, double sigma) {
      const double s = sigma > 0 ? sigma : default_sigma;
      return ScalarEstimate{size, s * s};
    };
    if (sides.length_complete)
      (a_is_length ? length : width) = estimate(sides.length, sides.length_sigma);
    if (sides.width_complete)
      (a_is_length ? width : length) = estimate(sides.width, sides.width_sigma);
  }

  void into(ScalarEstimate& l, ScalarEstimate& w) const {
    if (length) scalarUpdate(*length, l, kSideFloor);
    if (width) scalarUpdate(*width, w, kSideFloor);
  }

  /// Log likelihood given the track's likeliest class that has a heading, whose log probability is
  /// without what sides have said before.
  double fit(const ClassTable& classes, const Track& track) const {
    double best = kMinusInfinity;
    for (ClassId j = 0; j < classes.size(); ++j) {
      const ObjectClass& c = classes[j];
      if (!c.motion->has_heading) continue;
      best = std::max(best, track.log_class[static_cast<std::size_t>(j)] +
                                (length ? logSide(*length, c.length, c.length_sigma) : 0) +
                                (width ? logSide(*width, c.width, c.width_sigma) : 0));
    }
    return best;
  }
};

bool isLikelyVehicle(const Measurement& m, const ClassTable& classes) {
  for (std::size_t j = 0; j < m.log_class.size(); ++j)
    if (classes[static_cast<ClassId>(j)].shape == ObjectShape::kVehicle &&
        m.log_class[j] > kLikelyVehicle)
      return true;
  return false;
}

void seeSides(const Measurement& m, double axis, const FilterModel& model, Track& track) {
  const PartialBox& sides = *m.sides;
  if (m.view && isLikelyVehicle(m, model.classes))
    track.longest = std::max({track.longest, sides.length, sides.width});
  const double angle = std::abs(wrapAxis(sides.yaw - axis));  // [0, pi/2]
  if (angle > kAlong && angle < kPi / 2 - kAlong) return;
  const bool a_is_length = angle <= kAlong;
  const CompleteSides seen(sides, a_is_length, model.params.side_sigma),
      turned(sides, !a_is_length, model.params.side_sigma);
  seen.into(track.length, track.width);
  const bool across = m.view && turned.fit(model.classes, track) + std::log(kShareAcross) >
                                    seen.fit(model.classes, track);
  (across ? turned : seen).into(track.fitting_length, track.fitting_width);
}

/// Classes of vehicles for which what was seen is too long, where it is too high for two of them in
/// one cluster, with that share in full; vehicles together stay as likely as they are.
void addHighAndLong(const FilterModel& model, double longest_before, double height_before,
                    Track& track) {
  const double rest =
      std::log(kShareOfTwoHigh) - model.params.side_exponent * std::log(kShareOfTwo);
  const auto charge = [&](const ObjectClass& c, double longest, double height) {
    return height > kHigh && longest > 2 * c.length ? rest : 0.0;
  };
  double before = kMinusInfinity, after = kMinusInfinity;
  std::vector<double> log_class = track.log_class;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    const ObjectClass& c = model.classes[j];
    if (c.shape != ObjectShape::kVehicle) continue;
    double& lp = log_class[static_cast<std::size_t>(j)];
    before = logAddExp(before, lp);
    lp += charge(c, track.longest, track.height.mean) - charge(c, longest_before, height_before);
    after = logAddExp(after, lp);
  }
  if (!std::isfinite(before) || !std::isfinite(after)) return;
  for (ClassId j = 0; j < model.classes.size(); ++j)
    if (model.classes[j].shape == ObjectShape::kVehicle)
      track.log_class[static_cast<std::size_t>(j)] =
          log_class[static_cast<std::size_t>(j)] + before - after;
}

ScalarEstimate mixtureOf(const ClassTable& classes, double ObjectClass::*mean,
                         double ObjectClass::*sigma) {
  double sum = 0, square = 0;
  for (const auto& c : classes.classes) {
    sum += c.prior * c.*mean;
    square += c.prior * (c.*mean * c.*mean + c.*sigma * c.*sigma);
  }
  return {sum, square - sum * sum};
}

}  // namespace

void startSizes(const FilterModel& model, Track& track) {
  double height = 0, height_variance = 0;
  for (const auto& c : model.classes.classes) {
    height += c.prior * c.height;
    height_variance += c.prior * c.height_sigma * c.height_sigma;
  }
  track.height = {height, height_variance + 0.25};
  track.length = mixtureOf(model.classes, &ObjectClass::length, &ObjectClass::length_sigma);
  track.width = mixtureOf(model.classes, &ObjectClass::width, &ObjectClass::width_sigma);
  track.fitting_length = track.length, track.fitting_width = track.width;
}

void updateSizes(const Measurement& m, std::optional<double> axis, const FilterModel& model,
                 Track& track) {
  const auto& p = model.params;
  const double longest = track.longest, height = track.height.mean;
  const auto count = [&](double exponent, double any, const auto& whole, const auto& fitting,
                         const auto& see) {
    if (exponent <= 0) {
      see();
      return;
    }
    const auto add = [&](double sign) {
      for (ClassId j = 0; j < model.classes.size(); ++j) {
        const ObjectClass& c = model.classes[j];
        track.log_class[static_cast<std::size_t>(j)] +=
            sign * exponent * (m.view ? logPart(model.classes, c, any, whole, fitting) : whole(c));
      }
    };
    add(-1);
    see();
    add(1);
  };
  if (m.height) {
    const auto whole = [&](const ObjectClass& c) { return logHeight(c, track.height); };
    count(p.height_exponent, std::sqrt(kTwoPi) / kTallest, whole, whole,
          [&] { scalarUpdate(*m.height, track.height); });
  }
  if (m.sides && axis) {
    count(
        p.side_exponent, 1 / (kLargest * kWidest),
        [&](const ObjectClass& c) { return logSides(c, track.length, track.width); },
        [&](const ObjectClass& c) { return logFittingSides(c, track); },
        [&] { seeSides(m, *axis, model, track); });
  }
  if (m.view && p.side_exponent > 0) addHighAndLong(model, longest, height, track);
}

}  // namespace perception
