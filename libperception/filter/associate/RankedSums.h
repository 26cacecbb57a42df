#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// The `k` smallest sums of at most one alternative from each of several lists: merges the rankings
/// of independent parts. Ascending, the empty sum first.
class RankedSums {
 public:
  struct Sum {
    double loss = 0;
    std::int32_t last = -1;  ///< link of the alternative added last; -1: none
  };

  explicit RankedSums(std::size_t k) : k_(k), sums_(1) {}

  const std::vector<Sum>& sums() const { return sums_; }

  /// Adds a list of `losses` >= 0 in ascending order; sums above `limit` are dropped.
  void join(std::uint32_t list, const double* losses, std::size_t count, double limit) {
    if (count == 0 || losses[0] > bound(limit)) return;
    const std::size_t before = sums_.size();
    const double most = bound(limit);
    for (std::size_t i = 0; i < before; ++i) {
      for (std::size_t a = 0; a < count; ++a) {
        const double loss = sums_[i].loss + losses[a];
        if (loss > most || (before >= k_ && loss >= most)) break;  // later ones cost more
        links_.push_back({sums_[i].last, list, static_cast<std::uint32_t>(a)});
        sums_.push_back({loss, static_cast<std::int32_t>(links_.size()) - 1});
      }
    }
    std::stable_sort(sums_.begin(), sums_.end(),
                     [](const Sum& x, const Sum& y) { return x.loss < y.loss; });
    if (sums_.size() > k_) sums_.resize(k_);
  }

  /// Resets to an earlier state of the same object.
  void restart(const std::vector<Sum>& from) { sums_ = from; }

  /// Calls f(list, alternative) for each alternative in a sum.
  template <class Function>
  void forEachChange(const Sum& sum, const Function& f) const {
    for (std::int32_t i = sum.last; i >= 0; i = links_[static_cast<std::size_t>(i)].before) {
      const Link& l = links_[static_cast<std::size_t>(i)];
      f(l.list, l.alternative);
    }
  }

 private:
  struct Link {
    std::int32_t before;
    std::uint32_t list, alternative;
  };

  double bound(double limit) const {
    return sums_.size() >= k_ ? std::min(limit, sums_.back().loss) : limit;
  }

  std::size_t k_;
  std::vector<Sum> sums_;
  std::vector<Link> links_;
};

}  // namespace perception
