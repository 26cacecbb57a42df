#include "libperception/config/ShippedFiles.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

namespace fs = std::filesystem;

/// A working folder, and PERCEPTION_DATA with ini/site.ini, which includes ini/classes.ini.
class ShippedInis : public ::testing::Test {
 protected:
  ShippedInis() : inside_(folder_.path()) {
    fs::create_directories("data/ini/detectors");
    fs::create_directories("mine");
    writeText("data/ini/classes.ini", "[a]\nbeams = 7\n");
    writeText("data/ini/site.ini", "include = classes.ini\n[a]\ngain = 2\n");
    ::setenv("PERCEPTION_DATA", fs::absolute("data").c_str(), 1);
  }
  ~ShippedInis() override { ::unsetenv("PERCEPTION_DATA"); }

  TemporaryFolder folder_;
  WorkingFolder inside_;
};

TEST_F(ShippedInis, AreFoundByThePathInTheCheckoutAndByName) {
  EXPECT_EQ(readFile("ini/site.ini").beams, 7);
  EXPECT_EQ(readFile("site.ini").gain, 2);
}

TEST_F(ShippedInis, GiveWayToFilesOfThatPath) {
  writeText("site.ini", "[a]\ngain = 3\n");
  EXPECT_EQ(readFile("site.ini").gain, 3);
  EXPECT_EQ(readFile("ini/site.ini").gain, 2);
}

TEST_F(ShippedInis, AreIncludedByNameByAnIniElsewhere) {
  writeText("mine/car.ini", "include = site.ini\n[a]\nbeams = 9\n");
  EXPECT_EQ(readFile("mine/car.ini").gain, 2);
  EXPECT_EQ(readFile("mine/car.ini").beams, 9);
}

TEST_F(ShippedInis, AreNamedInTheEffectiveTextAsEveryFolderFindsThem) {
  writeText("data/ini/model.json", "{}");
  EXPECT_EQ(foundOrShipped("mine/model.json", "model.json"), fs::absolute("data/ini/model.json"));
  EXPECT_EQ(shippedName(fs::absolute("data/ini/model.json")), "ini/model.json");
  EXPECT_EQ(shippedName("data/ini/../ini/model.json"), "ini/model.json");
  writeText("mine/model.json", "{}");
  EXPECT_EQ(shippedName("mine/model.json"), "mine/model.json");
  EXPECT_EQ(shippedName("none.json"), "none.json");
  EXPECT_EQ(shippedName(""), "");
}

TEST_F(ShippedInis, OfNoSuchNameLeaveTheErrorOfThePath) {
  Config config = Config::fromFile("mine/none.ini");
  EXPECT_EQ(faultsOf(config), "mine/none.ini: cannot be read: No such file or directory");
}

TEST(ShippedFolder, OfABuildTreeIsTheTree) {
  ::unsetenv("PERCEPTION_DATA");
  EXPECT_TRUE(fs::equivalent(shippedFolder(), PERCEPTION_SOURCE_DIR)) << shippedFolder();
}

}  // namespace
}  // namespace perception::test
