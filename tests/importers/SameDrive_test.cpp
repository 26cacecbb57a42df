// One drive of our simulator, as it is and in the layouts of data sets: import, examination, tracks
// and evaluation are the same.
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "libperception/app/evaluate/EvaluateApp.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/StampText.h"
#include "tests/importers/DriveLayouts.h"
#include "tests/importers/ImportFixture.h"
#include "tests/support/CommandOutput.h"

namespace perception {
namespace {

using test::LayoutDrive;

constexpr std::size_t kLaidOut = 40;  // scans

class SameDrive : public test::ImportRun {
 protected:
  struct Outcome {
    std::vector<Scene> scenes;
    Evaluation evaluation;
    std::size_t truth_rows = 0;
  };

  void SetUp() override {
    const std::string demo = std::string(PERCEPTION_SOURCE_DIR) + "/rawlogs/demo";
    std::filesystem::create_symlink(demo + ".rawlog", file("out.rawlog"));
    const GroundTruth truth = readGroundTruth(demo + ".truth.csv");
    const auto frames = framesOf("LIDAR_TOP");
    std::filesystem::remove(file("out.rawlog"));
    const Pose3 T_new_old = frames.at(0).ego.T_world_ego.inverse();
    for (std::size_t k = 0; k < kLaidOut; ++k) {
      LayoutDrive::Scan scan;
      scan.cloud = std::get<LidarCloud>(frames.at(k).data);
      scan.cloud.ring.clear(), scan.cloud.time_offset.clear();  // most layouts hold none
      scan.T_world_ego = T_new_old * frames[k].ego.T_world_ego;
      for (TruthObject object : truth.instants.at(k).objects) {
        if (object.ignore || object.lidar_points <= 0) continue;
        if (object.type == "Van") object.type = "Car";
        object.position = T_new_old * object.position;
        object.yaw += yawOf(T_new_old);
        addBox(object, scan);
      }
      drive_.scans.push_back(std::move(scan));
    }
  }

  /// What tracking and evaluation make of the drive as the simulator tells it, from `begin` on.
  Outcome ownOutcome(Stamp begin) {
    ImportOptions options;
    options.output = file("out.rawlog");
    ImportLog log(options);
    log.expectTruth();
    BoxTruth truth(log);
    for (std::size_t k = 0; k < drive_.scans.size(); ++k) {
      const LayoutDrive::Scan& scan = drive_.scans[k];
      const Stamp stamp{begin.ns + static_cast<std::int64_t>(k) * 100'000'000};
      const auto number = static_cast<std::int64_t>(k);
      log.wants(number);
      log.ego(stamp, scan.T_world_ego);
      log.frame(stamp, number);
      SensorFrame frame;
      frame.sensor = "LIDAR_TOP", frame.stamp = stamp, frame.T_ego_sensor = LayoutDrive::mount();
      frame.data = scan.cloud;
      log.sensor(frame);
      std::vector<DataSetBox> boxes;
      for (const LayoutDrive::Box& box : scan.boxes) boxes.push_back(box.of_lidar);
      truth.add(boxes, number, stamp, scan.T_world_ego * LayoutDrive::mount(), scan.cloud);
    }
    result_ = log.close();
    return outcome();
  }
  /// Of out.rawlog; it is removed.
  Outcome outcome() {
    const auto examined = test::outputOf({PERCEPTION_BINARY_DIR "/bin/perception-doctor", "-i",
                                          file("out.rawlog"), "-o", file("doctor")});
    EXPECT_EQ(examined.code, 0) << examined.text;
    EXPECT_NE(examined.text.find(
                  "m above the ground, pitch -0.00 deg, roll 0.00 deg (median of 40 scans"),
              std::string::npos)
        << examined.text;
    Outcome outcome;
    outcome.scenes = track("demo.ini", "L");
    outcome.truth_rows = result_.truth_rows;
    EvaluateApp app;
    EXPECT_EQ(runQuietly(app, {"perception-evaluate", "-r", file("run"), "-t",
                               file("out.truth.csv"), "-o", file("report"), "--no-plots"}),
              0)
        << error_;
    if (!app.out_report.runs.empty()) outcome.evaluation = app.out_report.runs[0].evaluation;
    for (const char* done : {"out.rawlog", "out.truth.csv", "doctor", "report"})
      std::filesystem::remove_all(file(done));
    return outcome;
  }
  Outcome importedOutcome(const std::string& format, const std::vector<std::string>& options) {
    const int code = import(format, options);
    EXPECT_EQ(code, 0) << error_;
    EXPECT_EQ(result_.scans, static_cast<std::int64_t>(kLaidOut));
    EXPECT_EQ(result_.poses, static_cast<std::int64_t>(kLaidOut));
    std::uint64_t points = 0;
    for (const LayoutDrive::Scan& scan : drive_.scans) points += scan.cloud.size();
    EXPECT_EQ(result_.points, points);
    return outcome();
  }
  static void expectSameTracks(const Outcome& got, const Outcome& own) {
    ASSERT_EQ(got.scenes.size(), own.scenes.size());
    std::size_t objects = 0;
    for (std::size_t k = 0; k < own.scenes.size(); ++k) {
      const auto &a = got.scenes[k].objects, &b = own.scenes[k].objects;
      ASSERT_EQ(a.size(), b.size()) << "scene " << k;
      for (std::size_t i = 0; i < a.size(); ++i, ++objects) {
        EXPECT_EQ(a[i].id, b[i].id) << "scene " << k;
        EXPECT_EQ(a[i].class_id, b[i].class_id) << "scene " << k;
        EXPECT_LT((a[i].position - b[i].position).norm(), 1e-3) << "scene " << k;
        EXPECT_LT((a[i].velocity - b[i].velocity).norm(), 1e-2) << "scene " << k;
      }
    }
    EXPECT_GT(objects, 5 * kLaidOut);
  }
  static void expectSameEvaluation(const Outcome& got, const Outcome& own) {
    EXPECT_EQ(got.truth_rows, own.truth_rows);
    EXPECT_EQ(got.evaluation.truth_use, own.evaluation.truth_use);
    ASSERT_EQ(got.evaluation.samples.size(), own.evaluation.samples.size());
    EXPECT_GT(own.evaluation.samples.size(), 2 * kLaidOut);
    for (std::size_t i = 0; i < own.evaluation.samples.size(); ++i) {
      for (std::size_t p = 0; p < kPairings; ++p) {
        const auto &a = got.evaluation.samples[i].match[p], &b = own.evaluation.samples[i].match[p];
        ASSERT_EQ(a.has_value(), b.has_value()) << i;
        if (b) {
          EXPECT_NEAR(a->distance, b->distance, 2e-3) << i;
        }
      }
    }
    ASSERT_EQ(got.evaluation.instants.size(), own.evaluation.instants.size());
    for (std::size_t i = 0; i < own.evaluation.instants.size(); ++i)
      EXPECT_EQ(got.evaluation.instants[i].not_real, own.evaluation.instants[i].not_real) << i;
  }
  /// `folder`: what --dir names, below that of the layout; `begin`: when the layout says it was.
  void expectSame(const char* format,
                  const std::function<void(const LayoutDrive&, const test::KeepFile&)>& layOut,
                  const std::string& folder, std::vector<std::string> options = {},
                  Stamp begin = LayoutDrive::stamp(0)) {
    layOut(drive_, [this](const std::string& name, const std::string& bytes) {
      write("set/" + name, bytes);
    });
    options.insert(options.end(), {"--dir", file("set" + folder)});
    const Outcome got = importedOutcome(format, options);
    const Outcome own = ownOutcome(begin);
    expectSameTracks(got, own);
    expectSameEvaluation(got, own);
  }

  LayoutDrive drive_;

 private:
  static void addBox(const TruthObject& object, LayoutDrive::Scan& scan) {
    const Pose3 T_lidar_world = (scan.T_world_ego * LayoutDrive::mount()).inverse();
    LayoutDrive::Box box{{"o" + std::to_string(object.id), object.type, {}}, object};
    box.of_lidar.box.bottom_center = T_lidar_world * object.position;
    box.of_lidar.box.yaw = wrapAngle(object.yaw + yawOf(T_lidar_world));
    box.of_lidar.box.length = object.length, box.of_lidar.box.width = object.width;
    box.of_lidar.box.height = object.height;
    box.object.lidar_points = returnsInside(box.of_lidar.box, scan.cloud);
    if (box.object.lidar_points > 0) scan.boxes.push_back(std::move(box));
  }
};

TEST_F(SameDrive, AsTablesOfNuscenes) { expectSame("nuscenes", &test::layOutNuscenes, ""); }

TEST_F(SameDrive, AsADriveOfKittisRawData) {
  expectSame("kitti-raw", &test::layOutKittiRaw, "/drive");
}

TEST_F(SameDrive, AsASequenceOfCadc) {
  expectSame("cadc", &test::layOutCadc, "/0001/labeled", {"--lidar-height", "1.73"});
}

TEST_F(SameDrive, AsADriveOfBoreas) {
  expectSame("boreas", &test::layOutBoreas, "", {"--lidar-height", "1.73"});
}

TEST_F(SameDrive, AsASceneOfSemanticSpray) {
  expectSame("semanticspray", &test::layOutSpray, "", {"--lidar-height", "1.73"}, kUndatedStart);
}

/// Its truth is fitted about returns: a box has the extent of what was seen.
TEST_F(SameDrive, AsASequenceOfSemanticKitti) {
  test::layOutSemanticKitti(drive_, [this](const std::string& name, const std::string& bytes) {
    write("set/" + name, bytes);
  });
  const Outcome got = importedOutcome("semantickitti", {"--dir", file("set")});
  const Outcome own = ownOutcome(kUndatedStart);
  expectSameTracks(got, own);
  EXPECT_LE(got.truth_rows, own.truth_rows);  // too few returns make no box
  EXPECT_GT(got.truth_rows, own.truth_rows * 9 / 10);
}

}  // namespace
}  // namespace perception
