#include <gtest/gtest.h>

#include <filesystem>

#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

namespace fs = std::filesystem;

/// A working folder with ini/site.ini and what it includes.
class ConfigInclude : public ::testing::Test {
 protected:
  ConfigInclude() : inside_(folder_.path()) { fs::create_directories("ini/common"); }

  TemporaryFolder folder_;
  WorkingFolder inside_;
};

TEST_F(ConfigInclude, TheIncludingFileWinsWhereverTheLineStands) {
  writeText("ini/common/base.ini", "[a]\ngain = 1\nbeams = 5\n");
  writeText("ini/first.ini", "include = common/base.ini\n[a]\ngain = 2\n");
  writeText("ini/last.ini",
            "[a]\ngain = 2\n[z]\ninclude = common/base.ini ; classes\n[a]\nlabel = q\n");
  EXPECT_EQ(readFile("ini/first.ini").gain, 2);
  EXPECT_EQ(readFile("ini/first.ini").beams, 5);
  const auto last =
      readFile("ini/last.ini", "ini/last.ini:3: [z]: unknown section, did you mean [a]?");
  EXPECT_EQ(last.gain, 2);
  EXPECT_EQ(last.beams, 5);
  EXPECT_EQ(last.label, "q");
}

TEST_F(ConfigInclude, TheSectionGoesOnBehindTheInclude) {
  writeText("ini/base.ini", "[b]\n");
  writeText("ini/site.ini", "[a]\ninclude = base.ini\ngain = 2\n");
  Config config = Config::fromFile("ini/site.ini");
  EXPECT_EQ(config.read<AllKinds>("a").gain, 2);
  config.read<AllKinds>("b");
  EXPECT_EQ(faultsOf(config), "");
}

TEST_F(ConfigInclude, TwoIncludedFilesMustNotSayDifferentThings) {
  writeText("ini/x.ini", "[a]\ngain = 1\n");
  writeText("ini/y.ini", "\n[a]\ngain = 1\n");
  writeText("ini/site.ini", "include = x.ini\ninclude = y.ini\n");
  readFile("ini/site.ini", "ini/y.ini:3: [a] gain: duplicate, first in ini/x.ini:2");
  writeText("ini/site.ini", "include = x.ini\ninclude = y.ini\n[a]\ngain = 3\n");
  EXPECT_EQ(readFile("ini/site.ini").gain, 3);
}

TEST_F(ConfigInclude, AFileReachedByTwoWaysCountsOnceAndBothWinOverIt) {
  writeText("ini/base.ini", "[a]\ngain = 1\nbeams = 9\n");
  writeText("ini/x.ini", "include = base.ini\n");
  writeText("ini/y.ini", "[a]\ngain = 2\n[a]\ninclude = ./base.ini\n");
  writeText("ini/site.ini", "include = x.ini\ninclude = y.ini\n");
  const auto a = readFile("ini/site.ini");
  EXPECT_EQ(a.gain, 2);
  EXPECT_EQ(a.beams, 9);
}

TEST_F(ConfigInclude, CirclesAreNamed) {
  writeText("ini/x.ini", "include = common/y.ini\n");
  writeText("ini/common/y.ini", "[a]\ninclude = ../x.ini\n");
  readFile("ini/x.ini",
           "ini/common/y.ini:2: include: files include each other in a circle: ini/x.ini includes "
           "ini/common/y.ini includes ini/x.ini");
  writeText("ini/self.ini", "include = self.ini\n");
  readFile("ini/self.ini",
           "ini/self.ini:1: include: files include each other in a circle: ini/self.ini includes "
           "ini/self.ini");
}

TEST_F(ConfigInclude, AMissingIncludeHidesWhatOnlySeemsToBeMissing) {
  writeText("ini/site.ini", "include = clases.ini\n[sensor.A.class.car]\nx = 1\n[a]\ngain = no\n");
  Config config = Config::fromFile("ini/site.ini");
  config.read<AllKinds>("a");
  config.read<AllKinds>("needed", {}, true);
  EXPECT_EQ(faultsOf(config),
            "ini/site.ini:1: include: 'ini/clases.ini' cannot be read: No such file or directory\n"
            "ini/site.ini:5: [a] gain: found 'no', expected a number in 0.05 .. 5 [m]");
}

TEST_F(ConfigInclude, PathsStartAtTheFileThatHoldsTheLine) {
  writeText("ini/common/base.ini", "[a]\nmodel = ../nets/a.onnx\n");
  writeText("ini/site.ini", "include = common/base.ini\n");
  EXPECT_EQ(readFile("ini/site.ini").model, "ini/common/../nets/a.onnx");
  const std::string absolute = folder_ / "ini/site.ini";
  EXPECT_EQ(readFile(absolute).model, folder_ / "ini/common/../nets/a.onnx");
  writeText("ini/rooted.ini", "[a]\nmodel = /srv/a.onnx\n");
  EXPECT_EQ(readFile("ini/rooted.ini").model, "/srv/a.onnx");
  Config config = Config::fromFile("ini/site.ini");
  config.set("a.model=b.onnx");
  EXPECT_EQ(config.read<AllKinds>("a").model, "b.onnx");
}

TEST_F(ConfigInclude, EffectivePathsStillResolveFromAnyFolderOfTheFile) {
  writeText("ini/site.ini", "[a]\nmodel = nets/a.onnx\n");
  Config config = Config::fromFile("ini/site.ini");
  const auto params = config.read<AllKinds>("a");
  const std::string effective = config.effectiveText();
  EXPECT_EQ(effective.find(folder_.path()), std::string::npos);
  fs::create_directories("out/deep");
  writeText("out/deep/effective.ini", effective);
  EXPECT_EQ(readFile("out/deep/effective.ini").model, params.model);
  Config again = Config::fromFile("out/deep/effective.ini");
  again.read<AllKinds>("a");
  EXPECT_EQ(again.effectiveText(), effective);
}

TEST_F(ConfigInclude, NamesMayHoldSpacesAndUmlauts) {
  fs::create_directories("m\xC3\xBC ll");
  writeText("m\xC3\xBC ll/b c.ini", "[a]\ngain = 2\n");
  writeText("m\xC3\xBC ll/site.ini", "include = b c.ini\n");
  EXPECT_EQ(readFile("m\xC3\xBC ll/site.ini").gain, 2);
}

}  // namespace
}  // namespace perception::test
