// The plugin as users meet it: MRPT's own rawlog-edit reads our classes with it, and not without.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

/// Standard output and error of a shell command.
std::string outputOf(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> part{};
  for (std::size_t got = 0; (got = std::fread(part.data(), 1, part.size(), pipe)) > 0;) {
    text.append(part.data(), got);
  }
  ::pclose(pipe);
  return text;
}

class Plugin : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(plugin_)) GTEST_SKIP() << "not built: " << plugin_;
    if (outputOf("command -v rawlog-edit").empty())
      GTEST_SKIP() << "missing tool: rawlog-edit (package mrpt-apps)";
    writeLog(folder_ / "a.rawlog", 5);
  }
  std::string edit(const std::string& arguments) const {
    return outputOf("cd '" + folder_.path() + "' && rawlog-edit -i a.rawlog " + arguments);
  }
  const std::string plugin_ =
      std::string(PERCEPTION_BINARY_DIR) + "/lib/libperception_mrpt_plugin.so";
  TemporaryFolder folder_;
};

TEST_F(Plugin, StockProgramReadsTheWholeLogOnlyWithIt) {
  EXPECT_NE(edit("-p '" + plugin_ + "' --info").find("Overall number of objects         : 25"),
            std::string::npos);
  EXPECT_EQ(edit("--info").find("Overall number of objects         : 25"), std::string::npos);
}

TEST_F(Plugin, StockProgramExportsOurClassesAsText) {
  edit("-p '" + plugin_ + "' --export-txt");
  EXPECT_NE(readBytes(folder_ / "a_pointrcnn.txt").find("2 Car 8.2500"), std::string::npos);
  EXPECT_NE(readBytes(folder_ / "a_LIDAR_TOP.txt").find("200 200 10."), std::string::npos);
}

}  // namespace
}  // namespace perception
