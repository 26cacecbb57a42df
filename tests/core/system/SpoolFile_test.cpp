#include "libperception/core/system/SpoolFile.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::string heldBy(SpoolFile& spool) {
  std::string text;
  spool.copyTo([&](std::string_view piece) { text += piece; });
  return text;
}

TEST(SpoolFile, GivesBackWhatItGotAndLeavesNothing) {
  const TemporaryFolder folder;
  std::string all;
  {
    SpoolFile a(folder / "page.html", "a"), b(folder / "page.html", "b");
    EXPECT_EQ(heldBy(b), "");
    for (int i = 0; i < 50'000; ++i) {
      a.write("piece " + std::to_string(i));
      all += "piece " + std::to_string(i);
    }
    EXPECT_EQ(heldBy(a), all);
    EXPECT_FALSE(fs::is_empty(folder.path()));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SpoolFile, OfADeviceIsElsewhere) {
  SpoolFile spool("/dev/null", "run");
  spool.write("text");
  EXPECT_EQ(heldBy(spool), "text");
}

TEST(SpoolFile, SaysThatTheFolderIsMissing) {
  const TemporaryFolder folder;
  try {
    SpoolFile spool(folder / "missing/page.html", "run");
    FAIL() << "wrote into a folder that is not there";
  } catch (const OutputError& error) {
    EXPECT_EQ(error.code(), ExitCode::kCannotCreate);
  }
}

}  // namespace
}  // namespace perception
