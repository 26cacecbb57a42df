#include "libperception/core/system/PathPattern.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

TEST(PathPattern, FindsFilesInOrderAndPlainPathsThatExist) {
  const TemporaryFolder folder;
  for (const char* name : {"b.log", "a.log", "c.txt"}) std::ofstream(folder / name) << "x";
  EXPECT_EQ(pathsMatching(folder / "*.log"),
            (std::vector<std::string>{folder / "a.log", folder / "b.log"}));
  EXPECT_EQ(pathsMatching(folder / "c.txt"), std::vector<std::string>{folder / "c.txt"});
  EXPECT_TRUE(pathsMatching(folder / "d.txt").empty());
  EXPECT_TRUE(pathsMatching(folder / "*.d").empty());
}

}  // namespace
}  // namespace perception::test
