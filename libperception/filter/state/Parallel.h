#pragma once
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace perception {

/// f(0) ... f(n-1), in any order and on any number of threads; the calls must be independent. Runs
/// in the caller for few items or one thread, where tasks cost more than they gain.
template <class Function>
void parallelFor(std::size_t n, const Function& f) {
  constexpr std::size_t kWorthThreads = 24;
  if (n < kWorthThreads ||
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism) == 1) {
    for (std::size_t i = 0; i < n; ++i) f(i);
  } else {
    tbb::parallel_for(std::size_t{0}, n, f);
  }
}

}  // namespace perception
