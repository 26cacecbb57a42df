#include "libperception/boxes3d/BoxFeatures.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {
namespace {

constexpr double kMostMisfit = 16;   // four spreads: beyond, a box is as odd as it can be
constexpr double kNeighborhood = 2;  // [m]
constexpr double kSlopeRange = 10;   // [m]
constexpr int kColumns = 3 + static_cast<int>(kBoxFeatures);
using Row = Eigen::Matrix<double, kColumns, 1>;
using Square = Eigen::Matrix<double, kColumns, kColumns>;

double misfit(double value, double usual, double sigma) {
  const double z = (value - usual) / sigma;
  return std::min(z * z, kMostMisfit);
}

Row rowOf(const BoxSample& s) {
  Row row;
  row[0] = 1, row[1] = s.score, row[2] = s.range;
  for (std::size_t i = 0; i < kBoxFeatures; ++i)
    row[static_cast<Eigen::Index>(3 + i)] = s.features[i];
  return row;
}

BoxEvidence evidenceOf(const Row& w) {
  BoxEvidence e;
  e.slope = w[1];
  e.offset = w[1] != 0 ? -w[0] / w[1] : 0;
  e.fade = -w[2];
  for (std::size_t i = 0; i < kBoxFeatures; ++i) e.weights[i] = w[static_cast<Eigen::Index>(3 + i)];
  return e;
}

}  // namespace

BoxFeatureVector boxShape(const ObjectDetection::SpaceBox& box, double base,
                          const SizePrior& usual) {
  return {misfit(box.length, usual.length, usual.length_sigma),
          misfit(box.width, usual.width, usual.width_sigma),
          misfit(box.height, usual.height, usual.height_sigma),
          misfit(base, usual.base, usual.base_sigma)};
}

BoxFeatureVector boxFeatures(const ObjectDetections& detections, std::size_t index,
                             const SizePrior& usual, const Pose3& T_ego_sensor) {
  const ObjectDetection& own = detections.objects[index];
  const ObjectDetection::SpaceBox& box = *own.space_box;
  const double base = (T_ego_sensor * box.bottom_center).z();
  double nearest = std::numeric_limits<double>::infinity();
  for (const ObjectDetection& other : detections.objects) {
    if (other.label != own.label || other.score <= own.score || !other.space_box) continue;
    const Vector3 d = other.space_box->bottom_center - box.bottom_center;
    nearest = std::min(nearest, d.head<2>().norm());
  }
  BoxFeatureVector features = boxShape(box, base, usual);
  features[static_cast<std::size_t>(BoxFeature::kSlope)] =
      base * box.bottom_center.head<2>().norm() / kSlopeRange;
  features[static_cast<std::size_t>(BoxFeature::kNeighbor)] = std::exp(-nearest / kNeighborhood);
  return features;
}

double BoxEvidence::logOdds(double score, double range, const BoxFeatureVector& features) const {
  double sum = slope * (score - offset) - fade * range;
  for (std::size_t i = 0; i < kBoxFeatures; ++i) sum += weights[i] * features[i];
  return sum;
}

BoxEvidence fitBoxEvidence(const std::vector<BoxSample>& samples, bool with_features,
                           double ridge) {
  constexpr int kSteps = 30;
  if (samples.empty()) return {};
  // Columns in units of their own spread, so that one ridge suits all.
  Row spread = Row::Zero();
  for (const BoxSample& s : samples) spread += rowOf(s).cwiseAbs2();
  spread = (spread / static_cast<double>(samples.size())).cwiseSqrt().cwiseMax(1e-9);
  spread[0] = 1;
  Row w = Row::Zero();
  for (int step = 0; step < kSteps; ++step) {
    Row gradient = Row::Zero();
    Square hessian = Square::Zero();
    for (const BoxSample& s : samples) {
      Row x = rowOf(s).cwiseQuotient(spread);
      if (!with_features) x.tail<kColumns - 3>().setZero();
      const double p = 1 / (1 + std::exp(-w.dot(x)));
      gradient += ((s.object ? 1 : 0) - p) * x;
      hessian += p * (1 - p) * x * x.transpose();
    }
    Row penalty = Row::Constant(ridge);
    penalty[0] = 1e-6;
    gradient -= penalty.cwiseProduct(w);
    hessian.diagonal() += penalty;
    const Row change = hessian.ldlt().solve(gradient);
    w += change;
    if (change.norm() < 1e-9) break;
  }
  return evidenceOf(w.cwiseQuotient(spread));
}

double logLoss(const BoxEvidence& evidence, const std::vector<BoxSample>& samples) {
  double sum = 0;
  for (const BoxSample& s : samples) {
    const double odds = evidence.logOdds(s.score, s.range, s.features);
    const double against = s.object ? -odds : odds;
    sum += against > 30 ? against : std::log1p(std::exp(against));
  }
  return samples.empty() ? 0 : sum / static_cast<double>(samples.size());
}

}  // namespace perception
