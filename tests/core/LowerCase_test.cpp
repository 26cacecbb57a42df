#include "libperception/core/LowerCase.h"

#include <gtest/gtest.h>

namespace perception {
namespace {

TEST(LowerCase, ChangesLettersAlone) {
  EXPECT_EQ(lowerCase("Intensity_2 XYZ [m]"), "intensity_2 xyz [m]");
  EXPECT_EQ(lowerCase("\xC2\xB5S \xC3\x84"), "\xC2\xB5s \xC3\x84") << "letters of UTF-8 stay";
}

}  // namespace
}  // namespace perception
