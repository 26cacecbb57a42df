#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// What a box in space shows beside its score; each is a number without unit, 0 where it is as
/// expected, so that a weight of 0 leaves the score alone.
enum class BoxFeature : std::size_t {
  kLength,    ///< squared misfit of the length to the label's, in spreads, at most 16
  kWidth,     ///< the same of the width
  kHeight,    ///< the same of the height
  kBase,      ///< the same of the lower face's height above the vehicle's ground
  kSlope,     ///< height of the lower face [m] times range [10 m]: how ground rises ahead
  kNeighbor,  ///< exp(-d / 2 m) of the distance to the nearest box of the label with more score
};
inline constexpr std::size_t kBoxFeatures = 6;
inline constexpr std::array<const char*, kBoxFeatures> kBoxFeatureNames = {
    "length", "width", "height", "base", "slope", "neighbor"};
using BoxFeatureVector = std::array<double, kBoxFeatures>;

/// What boxes of one label usually measure, and their spread [m].
struct SizePrior {
  double length = 0, width = 0, height = 0, base = 0;
  double length_sigma = 1, width_sigma = 1, height_sigma = 1, base_sigma = 1;
};

/// The features of its shape alone; slope and neighbor are 0. `base` [m] above the ground.
BoxFeatureVector boxShape(const ObjectDetection::SpaceBox& box, double base,
                          const SizePrior& usual);
/// Features of the box number `index`; it must have a box in space. `T_ego_sensor` turns its lower
/// face into a height over the ground.
BoxFeatureVector boxFeatures(const ObjectDetections& detections, std::size_t index,
                             const SizePrior& usual, const Pose3& T_ego_sensor);

/// Log-odds of an object by score, range and features: intercept, score, range [m], features.
struct BoxEvidence {
  double offset = 0, slope = 0, fade = 0;  ///< slope (score - offset) - fade range
  BoxFeatureVector weights{};

  double logOdds(double score, double range, const BoxFeatureVector& features) const;
};

/// Ridge-regularized logistic regression by Newton's method of y in {0, 1} on score, range and
/// features, the latter two optional; rows are (score, range, features...). Empty data: zeros.
struct BoxSample {
  double score = 0, range = 0;  ///< [-], [m]
  BoxFeatureVector features{};
  bool object = false;
};
BoxEvidence fitBoxEvidence(const std::vector<BoxSample>& samples, bool with_features,
                           double ridge = 10);
/// Mean of -log P(what each sample is).
double logLoss(const BoxEvidence& evidence, const std::vector<BoxSample>& samples);

}  // namespace perception
