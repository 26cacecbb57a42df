// A sequence in SemanticKITTI's layout is written here: a car that stands and one that drives.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr int kSequenceScans = 12;
constexpr double kOwnStep = 0.5, kOtherStep = 1;  // [m] a scan, both along x

/// Returns of the sides of a box of 4 m by 1.8 m along x that a sensor at the origin sees.
void addBox(double x, double y, std::uint32_t label, std::vector<float>& numbers,
            std::vector<std::uint32_t>& labels) {
  const auto put = [&](double px, double py) {
    for (const double z : {-1.5, -0.2}) {
      for (const double v : {px, py, z, 0.5}) numbers.push_back(static_cast<float>(v));
      labels.push_back(label);
    }
  };
  for (int i = 0; i <= 40; ++i) put(x - 2 + 0.1 * i, y - std::copysign(0.9, y));
  for (int i = 0; i <= 18; ++i) put(x - 2, y - 0.9 + 0.1 * i);
}

class SemanticKittiImport : public test::ImportRun {
 protected:
  void SetUp() override {
    // Camera: x right, y down, z forward; at the lidar.
    write("08/calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
    std::string poses, times;
    for (int k = 0; k < kSequenceScans; ++k) {
      poses += fmt::format("1 0 0 0 0 1 0 0 0 0 1 {}\n", kOwnStep * k);
      times += fmt::format("{:e}\n", 0.104 * k);
      std::vector<float> numbers;
      std::vector<std::uint32_t> labels;
      addBox(15 - kOwnStep * k, 4, 10 + (7U << 16), numbers, labels);
      addBox(10 + (kOtherStep - kOwnStep) * k, -4, 252 + (9U << 16), numbers, labels);
      numbers.insert(numbers.end(), {6, 0, -1.7F, 0.1F}), labels.push_back(40);
      write(fmt::format("08/velodyne/{:06}.bin", k), bytesOf(numbers));
      write(fmt::format("08/labels/{:06}.label", k), bytesOf(labels));
    }
    write("08/poses.txt", poses), write("08/times.txt", times);
  }
  std::vector<std::string> sequence() const { return {"--dir", file("08")}; }
};

TEST_F(SemanticKittiImport, ScansHavePosesAndTimesOfTheSequence) {
  ASSERT_EQ(import("semantickitti", sequence()), 0) << error_;
  const auto scans = framesOf("LIDAR_TOP");
  ASSERT_EQ(scans.size(), 12U);
  EXPECT_NEAR(scans[4].ego.T_world_ego.translation().x(), 4 * kOwnStep, 1e-6);
  EXPECT_NEAR(scans[4].stamp - scans[0].stamp, 0.416, 1e-6);
  EXPECT_TRUE(std::filesystem::exists(file("out_Labels/000011.label")));
}

TEST_F(SemanticKittiImport, InstancesBecomeBoxesAboutTheirReturns) {
  ASSERT_EQ(import("semantickitti", sequence()), 0) << error_;
  const GroundTruth truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 12U);
  const auto& objects = truth.instants[6].objects;
  ASSERT_EQ(objects.size(), 2U);
  for (const TruthObject& o : objects) {
    const bool moves = o.position.y() < 0;
    SCOPED_TRACE(moves ? "drives" : "stands");
    EXPECT_EQ(o.type, "Car");
    EXPECT_NEAR(o.position.x(), moves ? 16 : 15, 0.05);
    EXPECT_NEAR(o.position.y(), moves ? -4 : 4, 0.05);
    EXPECT_NEAR(o.position.z(), 0.23, 0.01);
    EXPECT_NEAR(std::abs(std::sin(o.yaw)), 0, 0.04);
    EXPECT_NEAR(o.length, 4, 0.1);
    EXPECT_NEAR(o.width, 1.8, 0.1);
    EXPECT_NEAR(o.height, 1.3, 0.01);
    EXPECT_NEAR(o.vx, moves ? kOtherStep / 0.104 : 0, 0.1);
    EXPECT_FALSE(o.ignore);
    EXPECT_EQ(o.lidar_points, 120);
  }
}

TEST_F(SemanticKittiImport, WithoutLabelsThereAreScansAlone) {
  std::filesystem::remove_all(file("08/labels"));
  ASSERT_EQ(import("semantickitti", sequence()), 0) << error_;
  EXPECT_EQ(result_.scans, 12);
  EXPECT_FALSE(std::filesystem::exists(file("out.truth.csv")));
}

TEST_F(SemanticKittiImport, LabelsOfAnotherScanAreRefused) {
  write("08/labels/000003.label", "four");
  expectFault(65, "000003.label: 4 bytes, expected 4 (uint32) for each of the 241 points",
              "semantickitti", sequence());
}

}  // namespace
}  // namespace perception
