#include "libperception/scene/files/RunMark.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

const std::string kA(64, 'a'), kB(64, '1');

TEST(RunMark, IsFoundInAnyBytesOnceForEachRun) {
  EXPECT_EQ(runMark({kA, "", kB}), "perception run " + kA + ", perception run " + kB);
  const test::TemporaryFolder folder;
  std::ofstream(folder / "marks") << "..." << runMark({kB, kA}) << "\n" << runMark({kB});
  EXPECT_EQ(markedRunsOf(folder / "marks"), (std::vector<std::string>{kB, kA}));
  std::ofstream(folder / "words") << "perception run of Monday, perception run " << kA.substr(1);
  EXPECT_TRUE(markedRunsOf(folder / "words").empty());
}

TEST(RunMark, IsFoundAcrossThePartsThatAFileIsReadIn) {
  const test::TemporaryFolder folder;
  for (const std::size_t before :
       {0U, (1U << 20) - 40, (1U << 20) - 79, (1U << 20) - 1, 3U << 20}) {
    std::ofstream(folder / "f", std::ios::binary)
        << std::string(before, 'x') << runMark({kA}) << "x";
    EXPECT_EQ(markedRunsOf(folder / "f"), std::vector<std::string>{kA}) << before;
  }
  EXPECT_THROW(markedRunsOf(folder / "none"), DataError);
  EXPECT_THROW(markedRunsOf(folder.path()), DataError);
}

TEST(RunMark, OfAGzipFileLeavesItsContentAlone) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "grid.gridmap.gz";
  const gzFile out = gzopen(path.c_str(), "wb");
  gzputs(out, "cells");
  gzclose(out);
  markFile(path, runMark({kA}));
  EXPECT_EQ(markedRunsOf(path), std::vector<std::string>{kA});
  char content[16] = {};
  const gzFile in = gzopen(path.c_str(), "rb");
  EXPECT_EQ(gzread(in, content, sizeof content), 5);
  gzclose(in);
  EXPECT_STREQ(content, "cells");
}

TEST(RunMark, StandsWhereAFormatHasRoomForIt) {
  const std::string octree = "# Octomap OcTree file\nid OcTree\n";
  EXPECT_EQ(withMark(octree, runMark({kA})),
            "# Octomap OcTree file\n# perception run " + kA + "\nid OcTree\n");
  EXPECT_EQ(withMark("a,b\n", runMark({kA})), "a,b\n") << "no remark in a table";
  EXPECT_EQ(withMark(octree, ""), octree);
}

}  // namespace
}  // namespace perception
