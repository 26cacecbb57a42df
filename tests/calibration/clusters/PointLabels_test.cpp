#include "libperception/calibration/clusters/PointLabels.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using Labels = std::vector<std::uint32_t>;
using Classes = std::vector<std::uint16_t>;

std::string bytesOf(const Labels& labels) {
  return {reinterpret_cast<const char*>(labels.data()), labels.size() * sizeof(labels[0])};
}

/// A log's folder of labels.
struct LabeledLog {
  test::TemporaryFolder folder;
  std::string rawlog = folder / "drive.rawlog";

  LabeledLog() { std::filesystem::create_directory(folder / "drive_Labels"); }
  std::string path(const std::string& name) const { return folder / ("drive_Labels/" + name); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary) << bytes;
  }
  void writeZipped(const std::string& name, const std::string& bytes) const {
    const gzFile file = gzopen(path(name).c_str(), "wb");
    ASSERT_EQ(gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())),
              static_cast<int>(bytes.size()));
    ASSERT_EQ(gzclose(file), Z_OK);
  }
  std::string refusal(std::int64_t frame, std::size_t points) const {
    try {
      PointLabels(rawlog).ofFrame(frame, points);
    } catch (const DataError& e) {
      return e.what();
    }
    return "accepted";
  }
};

TEST(PointLabels, LyingSnowIsASurfaceAndFallingSnowIsNone) {
  EXPECT_TRUE(isPhantomLabel(110));
  EXPECT_FALSE(isPhantomLabel(111));
  EXPECT_TRUE(isPhantomLabel(112));
  EXPECT_TRUE(isPhantomLabel(117));
  EXPECT_TRUE(isPhantomLabel(118)) << "dirt on the window";
  EXPECT_FALSE(isPhantomLabel(119));
  EXPECT_FALSE(isPhantomLabel(10));
}

TEST(PointLabels, ReadsPlainAndZippedFilesOfTheFrame) {
  const LabeledLog log;
  log.write("000007.label", bytesOf({10, 30, 0}));
  log.writeZipped("12.label.gz", bytesOf({252, 40}));
  const PointLabels labels(log.rawlog);
  EXPECT_TRUE(labels.any());
  EXPECT_EQ(labels.ofFrame(7, 3), (Classes{10, 30, 0}));
  EXPECT_EQ(labels.ofFrame(12, 2), (Classes{252, 40}));
  EXPECT_EQ(labels.ofFrame(8, 3), std::nullopt);
}

TEST(PointLabels, TheUpperHalfIsAnInstanceAndNoClass) {
  const LabeledLog log;
  log.write("1.label", bytesOf({(77u << 16) | 10u}));
  EXPECT_EQ(PointLabels(log.rawlog).ofFrame(1, 1), Classes{10});
}

TEST(PointLabels, AFrameWithoutPointsMayHaveAnEmptyFile) {
  const LabeledLog log;
  log.write("1.label", "");
  EXPECT_EQ(PointLabels(log.rawlog).ofFrame(1, 0), Classes{});
}

TEST(PointLabels, ALogWithoutAFolderHasNone) {
  const test::TemporaryFolder folder;
  const PointLabels none(folder / "drive.rawlog");
  EXPECT_FALSE(none.any());
  EXPECT_EQ(none.ofFrame(0, 5), std::nullopt);
}

TEST(PointLabels, OtherFilesAreNoLabels) {
  const LabeledLog log;
  for (const char* name : {"readme.txt", "7.csv", "a7.label", "99999999999999999999.label"})
    log.write(name, bytesOf({10}));
  EXPECT_FALSE(PointLabels(log.rawlog).any());
}

TEST(PointLabels, RefusesAnotherNumberOfLabelsAndNamesFrameAndNumber) {
  const LabeledLog log;
  log.write("000007.label", bytesOf({10, 30, 0}));
  log.writeZipped("8.label.gz", bytesOf({10, 30, 0}));
  log.write("9.label", bytesOf({10, 30, 0}) + "x");
  for (const std::int64_t frame : {7, 8, 9}) {
    for (const std::size_t points : {2u, 4u}) {
      const std::string words = "expected " + std::to_string(points) +
                                " labels, one uint32 for each point of frame " +
                                std::to_string(frame);
      EXPECT_NE(log.refusal(frame, points).find(words), std::string::npos)
          << log.refusal(frame, points);
    }
  }
  EXPECT_NE(log.refusal(7, 2).find(log.path("000007.label")), std::string::npos);
  EXPECT_EQ(log.refusal(7, 3), "accepted");
  EXPECT_NE(log.refusal(9, 3), "accepted");
}

TEST(PointLabels, RefusesDamagedFiles) {
  const LabeledLog log;
  Labels many;
  for (std::uint32_t i = 0; i < 5000; ++i) many.push_back(i * 2654435761u % 997);
  log.writeZipped("1.label.gz", bytesOf(many));
  ASSERT_EQ(log.refusal(1, 5000), "accepted");
  std::filesystem::resize_file(log.path("1.label.gz"),
                               std::filesystem::file_size(log.path("1.label.gz")) / 2);
  EXPECT_NE(log.refusal(1, 5000).find("1.label.gz"), std::string::npos) << "cut";
  std::filesystem::create_directory(log.path("2.label"));
  EXPECT_NE(log.refusal(2, 5000).find("2.label"), std::string::npos) << "a folder";
}

}  // namespace
}  // namespace perception
