#include "libperception/calibration/detectors/Intervals.h"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace perception {
namespace {

constexpr double kTail = 0.05;            // outside of the interval on either side
constexpr std::size_t kFewestBlocks = 3;  // blocks that show a variance

BlockCount sumOf(const std::vector<BlockCount>& blocks) {
  BlockCount sum;
  for (const BlockCount& b : blocks) sum.events += b.events, sum.chances += b.chances;
  return sum;
}

}  // namespace

double designEffect(const std::vector<BlockCount>& blocks, double variance_of_one) {
  const BlockCount sum = sumOf(blocks);
  if (blocks.size() < kFewestBlocks || sum.chances <= 0 || variance_of_one <= 0) return 1;
  const double rate = sum.events / sum.chances;
  double squares = 0;
  for (const BlockCount& b : blocks) {
    const double off = b.events - rate * b.chances;
    squares += off * off;
  }
  const auto n = static_cast<double>(blocks.size());
  // The variance of few blocks is itself uncertain: Student's quantile instead of the Gaussian's.
  const double wider = boost::math::quantile(boost::math::students_t(n - 1), kTail) /
                       boost::math::quantile(boost::math::normal(), kTail);
  return std::max(1.0, wider * wider * squares * n / (n - 1) / (variance_of_one * sum.chances));
}

CredibleInterval shareInterval(const std::vector<BlockCount>& blocks) {
  const BlockCount sum = sumOf(blocks);
  const double share = sum.chances > 0 ? sum.events / sum.chances : 0.5;
  const double fewer = designEffect(blocks, share * (1 - share));
  const boost::math::beta_distribution<> beta(sum.events / fewer + 0.5,
                                              (sum.chances - sum.events) / fewer + 0.5);
  return {(sum.events + 0.5) / (sum.chances + 1), boost::math::quantile(beta, kTail),
          boost::math::quantile(beta, 1 - kTail)};
}

CredibleInterval rateInterval(const std::vector<BlockCount>& blocks) {
  const BlockCount sum = sumOf(blocks);
  if (sum.chances <= 0) return {};
  const double fewer = designEffect(blocks, sum.events / sum.chances);
  const boost::math::gamma_distribution<> gamma(sum.events / fewer + 0.5, fewer / sum.chances);
  return {sum.events / sum.chances, boost::math::quantile(gamma, kTail),
          boost::math::quantile(gamma, 1 - kTail)};
}

}  // namespace perception
