#include "studies/weather/SnowForest.h"

#include <algorithm>
#include <numeric>
#include <opencv2/ml.hpp>

#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"

namespace perception {
namespace {

constexpr int kTrees = 40, kDepth = 12, kLeastInLeaf = 10;
constexpr std::uint32_t kPermutePurpose = 0x5f0e57;

cv::Mat matrixOf(const std::vector<SnowRow>& rows) {
  cv::Mat samples(static_cast<int>(rows.size()), static_cast<int>(kSnowFeatures), CV_32F);
  for (int i = 0; i < samples.rows; ++i) {
    const SnowFeatures& features = rows[static_cast<std::size_t>(i)].features;
    std::copy(features.begin(), features.end(), samples.ptr<float>(i));
  }
  return samples;
}

}  // namespace

double areaUnderCurve(const std::vector<double>& scores, const std::vector<SnowRow>& rows) {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return scores[a] < scores[b]; });
  double below = 0, wins = 0, real = 0;
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    double simulated_here = 0, real_here = 0;
    for (; to < order.size() && scores[order[to]] == scores[order[from]]; ++to)
      (rows[order[to]].real ? real_here : simulated_here) += 1;
    wins += real_here * (below + .5 * simulated_here);
    below += simulated_here, real += real_here;
  }
  return real > 0 && below > 0 ? wins / (real * below) : 0.5;
}

struct SnowForest::Trees {
  cv::Ptr<cv::ml::RTrees> model = cv::ml::RTrees::create();
};

// Trees of 0 and 1 as numbers: their mean is the score.
SnowForest::SnowForest(const std::vector<SnowRow>& rows, std::uint64_t seed)
    : trees_(std::make_unique<Trees>()) {
  const auto both = std::count_if(rows.begin(), rows.end(), [](const auto& r) { return r.real; });
  if (both == 0 || both == static_cast<std::ptrdiff_t>(rows.size()))
    throw DataError("snow of one kind alone: nothing to tell apart");
  const cv::Mat samples = matrixOf(rows);
  cv::Mat truth(samples.rows, 1, CV_32F);
  for (int i = 0; i < truth.rows; ++i)
    truth.at<float>(i) = rows[static_cast<std::size_t>(i)].real ? 1 : 0;
  auto& model = *trees_->model;
  model.setMaxDepth(kDepth);
  model.setMinSampleCount(kLeastInLeaf);
  model.setRegressionAccuracy(0);
  model.setTermCriteria({cv::TermCriteria::MAX_ITER, kTrees, 0});
  cv::theRNG().state = seed + 1;  // 0 would draw zeros
  model.train(samples, cv::ml::ROW_SAMPLE, truth);
}

SnowForest::~SnowForest() = default;

double SnowForest::area(const std::vector<SnowRow>& rows) const {
  if (rows.empty()) return areaUnderCurve({}, rows);
  const cv::Mat samples = matrixOf(rows);
  cv::Mat found;
  trees_->model->predict(samples, found);
  std::vector<double> scores;
  for (int i = 0; i < found.rows; ++i) scores.push_back(static_cast<double>(found.at<float>(i)));
  return areaUnderCurve(scores, rows);
}

std::vector<double> SnowForest::importance(std::vector<SnowRow> rows, std::uint64_t seed) const {
  const double whole = area(rows);
  std::vector<double> falls;
  for (std::size_t f = 0; f < kSnowFeatures; ++f) {
    std::vector<float> kept;
    for (const SnowRow& row : rows) kept.push_back(row.features[f]);
    std::vector<float> mixed = kept;
    Rng rng({seed, f, 0, kPermutePurpose});
    for (std::size_t i = mixed.size(); i > 1; --i)
      std::swap(mixed[i - 1], mixed[rng.below(static_cast<std::uint32_t>(i))]);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].features[f] = mixed[i];
    falls.push_back(whole - area(rows));
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].features[f] = kept[i];
  }
  return falls;
}

}  // namespace perception
