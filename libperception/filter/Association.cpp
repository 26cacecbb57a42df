#include "libperception/filter/Association.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/core/LogMath.h"

namespace perception {

AssociationIndex::AssociationIndex(const std::vector<Track>& predicted,
                                   const LikelihoodTable& table)
    : by_measurement_(table.news.size()) {
  log_miss_.reserve(predicted.size());
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    const double r = predicted[i].existence;
    log_miss_.push_back(std::log1p(-r * table.tracks[i].detection));
    for (const auto& pair : table.tracks[i].pairs) {
      by_measurement_[pair.measurement].push_back(
          {i, std::log(r) + pair.log_likelihood - log_miss_.back()});
    }
  }
  for (const auto& n : table.news) log_new_.push_back(n.log_new);
}

Association associate(const std::vector<std::size_t>& tracks, const AssociationIndex& index,
                      const std::vector<std::size_t>& order, Rng rng) {
  Association result;
  result.cause.assign(index.measurements(), Association::kNew);
  std::vector<int> place(index.tracks(),
                         -1);  // of a distinct track in this hypothesis; -1: absent or used
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    place[tracks[i]] = static_cast<int>(i);
    result.log_weight += index.logMiss(tracks[i]);  // all provisionally missed
  }
  std::vector<double> log_odds;
  std::vector<std::size_t> owner;
  for (const std::size_t k : order) {
    log_odds.assign(1, index.logNew(k));
    owner.assign(1, 0);
    for (const auto& c : index.candidates(k)) {
      if (place[c.track] < 0) continue;
      log_odds.push_back(c.log_odds);
      owner.push_back(c.track);
    }
    const double total = logSumExp(log_odds);
    if (total == kMinusInfinity)
      continue;  // impossible under every cause: clutter of an unmodelled kind, no evidence
    result.log_weight += total;
    double u = rng.uniform();
    std::size_t chosen = 0;
    for (; chosen + 1 < log_odds.size(); ++chosen) {
      u -= std::exp(log_odds[chosen] - total);
      if (u < 0) break;
    }
    if (chosen == 0) continue;
    result.cause[k] = std::exchange(place[owner[chosen]], -1);
  }
  return result;
}

std::vector<std::size_t> randomOrder(std::size_t n, Rng rng) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i)
    std::swap(order[i - 1], order[rng.below(static_cast<std::uint32_t>(i))]);
  return order;
}

}  // namespace perception
