#include "libperception/app/ExportApp.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "libperception/scene/TrackedRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

const std::string kLog = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";

// Eleven scenes, a car in the first five.
class ExportAppTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "export_app_" +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  void writeRun(Stamp first) {
    ClassTable classes;
    classes.classes.emplace_back();
    classes.classes.back().name = "car";
    TrackedRunWriter writer(dir_, classes, first);
    for (int k = 0; k < 11; ++k) {
      Scene scene;
      scene.stamp = first + 0.1 * k;
      SceneObject car;
      car.id = 7;
      car.class_probability = {1.0};
      car.speed = 2.5;
      car.length = car.width = car.height = 1;
      if (k < 5) scene.objects = {car};
      writer.write(scene);
    }
    writer.close();
  }

  int run() {
    const std::string out = dir_ + "/a.mcap";
    const char* argv[] = {"perception-export", "-i", kLog.c_str(), "-r",
                          dir_.c_str(),        "-o", out.c_str()};
    return runApp(app_, 7, argv);
  }

  // Standard output and errors of a command, and how it ended.
  static std::pair<int, std::string> outputOf(const std::string& command) {
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    std::array<char, 4096> part;
    while (const auto n = std::fread(part.data(), 1, part.size(), pipe))
      text.append(part.data(), n);
    return {pclose(pipe), text};
  }

  std::string dir_;
  ExportApp app_;
};

TEST_F(ExportAppTest, ALogOfOtherTimesIsRefused) {
  writeRun(Stamp::fromSeconds(1));
  EXPECT_EQ(run(), static_cast<int>(ExitCode::kBadInput));
  EXPECT_FALSE(fs::exists(dir_ + "/a.mcap"));
}

TEST_F(ExportAppTest, PythonReadsTheRun) {
  if (outputOf("/usr/bin/python3 -c 'import numpy'").first != 0)
    GTEST_SKIP() << "python3-numpy is missing";
  writeRun(Stamp{1'600'000'000'123'456'789});
  const auto [code, text] = outputOf(
      "cd " PERCEPTION_SOURCE_DIR
      "/apps/perception-export && /usr/bin/python3 -B -c \""
      "from perception_run import Run; r = Run('" +
      dir_ +
      "'); "
      "print(len(r.scenes), len(r.track(7)), r.tracks['stamp_ns'][0], r.tracks['speed'][0], "
      "r.probability('car')[0], r.classes)\"");
  EXPECT_EQ(code, 0);
  EXPECT_EQ(text, "11 5 1600000000123456789 2.5 1.0 ['car']\n");
}

}  // namespace
}  // namespace perception
