#include "libperception/core/system/Parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <numeric>
#include <stdexcept>
#include <vector>

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

TEST(WorkBehind, IsDoneInTheOrderInWhichItIsGiven) {
  std::vector<int> done, wanted(1000);
  std::iota(wanted.begin(), wanted.end(), 0);
  WorkBehind work;
  for (const int k : wanted) {
    EXPECT_EQ(work.add([&done, k] { done.push_back(k); }), static_cast<std::size_t>(k) + 1);
    if (k % 100 != 99) continue;
    work.wait();
    EXPECT_EQ(done.size(), static_cast<std::size_t>(k) + 1);
  }
  EXPECT_EQ(done, wanted);
}

TEST(WorkBehind, TheFirstMayBeWaitedForAlone) {
  WorkBehind work;
  std::atomic<int> done = 0;
  std::promise<void> go;
  const std::size_t first = work.add([&] { ++done; });
  work.add([&, gone = go.get_future().share()] { gone.wait(), ++done; });
  work.wait(first);  // else for ever
  EXPECT_EQ(done, 1);
  go.set_value();
  work.wait();
  EXPECT_EQ(done, 2);
}

TEST(WorkBehind, ThrowsWhatTheFirstThrewAndLeavesOutTheRest) {
  int done = 0;
  WorkBehind work;
  for (int k = 0; k < 2; ++k) {
    work.add([&] { ++done; });
    work.add([] { throw std::runtime_error("full"); });
    EXPECT_THROW(work.wait(), std::runtime_error);
    work.wait();
    EXPECT_EQ(done, k + 1);
  }
  work.add([&] { ++done; });  // done before it goes
}

}  // namespace
}  // namespace perception
