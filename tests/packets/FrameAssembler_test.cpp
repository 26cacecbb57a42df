#include "libperception/packets/FrameAssembler.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace perception {
namespace {

TEST(FrameAssembler, ManyDamagedPacketsHideNoEvent) {
  FrameAssembler assembler(deviceKind("xt32"), "", "roof", Pose3::Identity(), [](SensorFrame&&) {});
  for (int i = 0; i < 150; ++i) assembler.add("no packet", Stamp{i});
  assembler.note("connected to 10.0.0.3:12002");
  const std::vector<std::string> told = assembler.warnings();
  ASSERT_EQ(told.size(), 102U);
  EXPECT_EQ(told[100], "roof: 50 more packets with a fault");
  EXPECT_EQ(told[101], "roof: packet 150: connected to 10.0.0.3:12002");
  EXPECT_EQ(assembler.ledger().damaged, 150U);
}

}  // namespace
}  // namespace perception
