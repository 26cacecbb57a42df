#include "libperception/capture/sources/SenderGuard.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(SenderGuard, TheSecondIsHeardOnceTheFirstIsSilent) {
  SenderGuard guard;
  const Stamp t{1700000000000000000};
  EXPECT_TRUE(guard.passes(1, t));
  EXPECT_FALSE(guard.takeEvent());
  EXPECT_FALSE(guard.passes(2, t + 0.1));
  EXPECT_TRUE(guard.takeEvent());
  EXPECT_FALSE(guard.passes(2, t + 0.2));
  EXPECT_FALSE(guard.takeEvent()) << "one line for each second sender";
  EXPECT_TRUE(guard.passes(1, t + 0.5));
  EXPECT_FALSE(guard.passes(2, t + 1.4));
  EXPECT_TRUE(guard.passes(2, t + 1.6));
  EXPECT_TRUE(guard.takeEvent());
  EXPECT_FALSE(guard.passes(1, t + 1.7));
  EXPECT_EQ(guard.refused(), 4U);
}

}  // namespace
}  // namespace perception
