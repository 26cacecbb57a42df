#include "libperception/app/StudyApp.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

TEST(StudyApp, LeavesAReportWithTablesAndPlots) {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/heading";
  StudyApp app;
  const char* argv[] = {"perception-study", "heading", "-o", out.c_str(), "--runs", "4"};
  ASSERT_EQ(runApp(app, 6, argv), 0);
  for (const char* name : {"report.md", "camera.csv", "camera_and_radar.csv", "heading_camera.png"})
    EXPECT_TRUE(std::filesystem::exists(out + "/" + name)) << name;
  std::ifstream file(out + "/report.md");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_NE(text.str().find("Data: simulated"), std::string::npos);
}

TEST(StudyApp, UnknownStudiesAreAUsageError) {
  StudyApp app;
  const char* argv[] = {"perception-study", "tea-leaves", "-o", "nowhere"};
  EXPECT_EQ(runApp(app, 4, argv), static_cast<int>(ExitCode::kUsage));
}

}  // namespace
}  // namespace perception
