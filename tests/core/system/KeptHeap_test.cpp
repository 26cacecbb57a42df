#include "libperception/core/system/KeptHeap.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "libperception/core/system/MemoryLimit.h"

namespace perception {
namespace {

long pageFaults() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

// As a scan does: some megabytes in blocks of different sizes, touched and freed.
void useMemory() {
  std::vector<std::vector<char>> blocks;
  for (const std::size_t kilobytes : {100, 500, 2000, 4000, 8000}) {
    blocks.emplace_back(kilobytes << 10, 'x');
    const volatile char* touched = &blocks.back().front();
    (void)*touched;
  }
}

TEST(KeptHeap, TheSecondScanTakesNoPagesFromTheKernel) {
  if (!MemoryLimit::supported()) GTEST_SKIP() << "a sanitizer's own allocator";
  const auto faultsOfSecond = [] {
    keepFreedMemory();
    useMemory();
    const long before = pageFaults();
    useMemory();
    const long faults = pageFaults() - before;
    if (faults > 20) std::fprintf(stderr, "%ld faults\n", faults);
    std::_Exit(faults > 20);
  };
  EXPECT_EXIT(faultsOfSecond(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace perception
