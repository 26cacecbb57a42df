#include "libperception/filter/state/Parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace perception {
namespace {

TEST(RunBoth, CallsEachOnceWhateverTheNumberOfThreads) {
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    int first = 0, second = 0;
    for (int k = 0; k < 100; ++k) runBoth([&] { ++first; }, [&] { ++second; });
    EXPECT_EQ(first, 100);
    EXPECT_EQ(second, 100);
  }
}

TEST(RunBoth, AnExceptionOfEitherReachesTheCaller) {
  const auto fails = [] { throw std::runtime_error("full"); };
  const auto nothing = [] {};
  EXPECT_THROW(runBoth(fails, nothing), std::runtime_error);
  EXPECT_THROW(runBoth(nothing, fails), std::runtime_error);
}

}  // namespace
}  // namespace perception
