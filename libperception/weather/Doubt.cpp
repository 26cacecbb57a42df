#include "libperception/weather/Doubt.h"

#include <algorithm>
#include <numeric>

namespace perception {

Doubt OddsParts::largest() const {
  const auto most = std::max_element(of.begin(), of.end());
  return {static_cast<DoubtCause>(most - of.begin()), static_cast<double>(*most)};
}

void DoubtCounts::add(const Doubt& doubt) {
  const auto c = static_cast<std::size_t>(doubt.cause);
  ++returns[c], evidence[c] += doubt.evidence;
}

void DoubtCounts::remove(const Doubt& doubt) {
  const auto c = static_cast<std::size_t>(doubt.cause);
  --returns[c], evidence[c] -= doubt.evidence;
}

DoubtCounts& DoubtCounts::operator+=(const DoubtCounts& other) {
  for (std::size_t c = 0; c < kDoubtCauses; ++c)
    returns[c] += other.returns[c], evidence[c] += other.evidence[c];
  return *this;
}

std::size_t DoubtCounts::total() const {
  return std::accumulate(returns.begin(), returns.end(), std::size_t{0});
}

}  // namespace perception
