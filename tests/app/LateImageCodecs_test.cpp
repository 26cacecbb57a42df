#include <gtest/gtest.h>
#include <mrpt/img/CImage.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "libperception/core/system/ChildProcess.h"
#include "libperception/sensors/images/ImageFile.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

namespace fs = std::filesystem;

const fs::path kBuild(PERCEPTION_BINARY_DIR);

class LateImageCodecs : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kBuild / PERCEPTION_PLUGIN_DIR))
      GTEST_SKIP() << "built without (PERCEPTION_LATE_IMAGE_CODECS)";
  }

  /// What the words print; empty if they end with another code than 0.
  std::string outputOf(const std::vector<std::string>& words) const {
    ChildCommand command;
    command.words = words;
    command.output = folder_ / "output";
    ChildProcess process(command);
    process.wait();
    std::ostringstream text;
    if (process.exitCode() == 0) text << std::ifstream(command.output).rdbuf();
    return text.str();
  }
  /// As ldd does.
  std::string librariesOf(const std::string& program) const {
    return outputOf({"env", "LD_TRACE_LOADED_OBJECTS=1", program});
  }

  const TemporaryFolder folder_;
};

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(LateImageCodecs, AProgramStartsWithoutTheLibrariesOfPictureFiles) {
  const std::string libraries = librariesOf(kBuild / "bin/perception-track");
  EXPECT_TRUE(has(libraries, PERCEPTION_PLUGIN_DIR "/libopencv_imgcodecs.so.")) << libraries;
  EXPECT_FALSE(has(libraries, "libgdal")) << libraries;
}

TEST_F(LateImageCodecs, AProgramThatIsCopiedElsewhereHasOpenCvsOwn) {
  fs::create_directory(folder_ / "bin");
  const std::string copied = folder_ / "bin/perception-track";
  fs::copy_file(kBuild / "bin/perception-track", copied);
  const std::string libraries = librariesOf(copied);
  EXPECT_TRUE(has(libraries, "libopencv_imgcodecs.so.")) << libraries;
  EXPECT_FALSE(has(libraries, PERCEPTION_PLUGIN_DIR "/")) << libraries;
  EXPECT_TRUE(has(outputOf({copied, "--version"}), "perception-track "));
}

TEST_F(LateImageCodecs, PicturesAreWrittenAndReadByOpenCvAndByMrpt) {
  const std::string this_program = fs::read_symlink("/proc/self/exe");
  ASSERT_FALSE(has(librariesOf(this_program), "libgdal")) << "not as perception's programs are";
  for (const char* name : {"picture.png", "picture.jpg"}) {
    const std::string file = folder_ / name;
    ASSERT_TRUE(cv::imwrite(file, cv::Mat(20, 30, CV_8UC3, cv::Scalar(10, 120, 230))));
    const cv::Mat read = readImageFile(file, cv::IMREAD_COLOR);
    ASSERT_EQ(read.size(), cv::Size(30, 20)) << name;
    EXPECT_NEAR(read.at<cv::Vec3b>(10, 10)[2], 230, 3) << name;
    mrpt::img::CImage image;
    ASSERT_TRUE(image.loadFromFile(file)) << name;
    EXPECT_EQ(image.getWidth(), 30U);
    ASSERT_TRUE(image.saveToFile(folder_ / std::string("mrpt_") + name)) << name;
    std::vector<std::uint8_t> bytes;
    ASSERT_TRUE(cv::imencode(fs::path(name).extension(), read, bytes));
    EXPECT_EQ(cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).size(), cv::Size(30, 20)) << name;
  }
}

TEST_F(LateImageCodecs, WhatIsNoPictureIsAnEmptyOne) {
  std::ofstream(folder_ / "text.png") << "no picture";
  EXPECT_TRUE(readImageFile(folder_ / "text.png", cv::IMREAD_COLOR).empty());
  EXPECT_TRUE(readImageFile(folder_ / "missing.png", cv::IMREAD_COLOR).empty());
}

}  // namespace
}  // namespace perception::test
