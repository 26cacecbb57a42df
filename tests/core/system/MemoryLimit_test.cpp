#include "libperception/core/system/MemoryLimit.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace perception {
namespace {

constexpr std::uint64_t kGigabyte = 1ULL << 30;

rlim_t softLimit() {
  struct rlimit limit {};
  ::getrlimit(RLIMIT_AS, &limit);
  return limit.rlim_cur;
}

TEST(MemoryLimit, HoldsWhileItLives) {
  if (!MemoryLimit::supported()) GTEST_SKIP() << "sanitizers reserve terabytes";
  const rlim_t before = softLimit();
  {
    const MemoryLimit limit(64 * kGigabyte);
    EXPECT_EQ(softLimit(), 64 * kGigabyte);
    const MemoryLimit wider(128 * kGigabyte);  // a limit is never raised
    EXPECT_EQ(softLimit(), 64 * kGigabyte);
  }
  EXPECT_EQ(softLimit(), before);
}

}  // namespace
}  // namespace perception
