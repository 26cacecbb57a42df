#pragma once
#include <tbb/parallel_for.h>

#include <cstddef>

namespace perception {

/// f(0) ... f(n-1), each independent of the others, in any order and on any number of threads. Few
/// items are done at once by the caller: waking threads would cost more.
template <class Function>
void parallelFor(std::size_t n, const Function& f) {
  constexpr std::size_t kWorthThreads = 24;
  if (n < kWorthThreads) {
    for (std::size_t i = 0; i < n; ++i) f(i);
  } else {
    tbb::parallel_for(std::size_t{0}, n, f);
  }
}

}  // namespace perception
