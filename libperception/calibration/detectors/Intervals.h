#pragma once
#include <cstddef>
#include <vector>

namespace perception {

/// An estimate and its 90 % credible interval.
struct CredibleInterval {
  double value = 0, low = 0, high = 0;
};

/// Events among chances within one block of time, in which they may depend on each other.
struct BlockCount {
  double events = 0, chances = 0;
};

/// How much larger the variance of a sum of blocks is than if all chances were independent, at
/// least 1 (design effect), widened by Student's quantile of their number; `variance_of_one` is
/// that of one chance at the mean rate. 1 with less than three blocks.
double designEffect(const std::vector<BlockCount>& blocks, double variance_of_one);

/// Share of the chances at which the event happens: Beta posterior under Jeffreys' prior, counts
/// divided by the design effect (method.md 8.14).
CredibleInterval shareInterval(const std::vector<BlockCount>& blocks);
/// Events a chance, which may be more than one: Gamma posterior under Jeffreys' prior, the same.
CredibleInterval rateInterval(const std::vector<BlockCount>& blocks);

}  // namespace perception
