#include "libperception/app/evaluate/EvaluateApp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 20;

// A folder with the truth of a car that comes near, a run that tracks it from the third frame on,
// and a perfect run.
class EvaluateAppTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "evaluate app " +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    std::vector<TruthObject> truth;
    for (int k = 0; k < kFrames; ++k) truth.push_back(truthAt(k));
    fs::create_directories(dir_);
    writeGroundTruth(dir_ + "/log.truth.csv", truth);
    writeRun("late", 2, 0.5);
    writeRun("perfect", 0, 0);
  }
  void TearDown() override { fs::remove_all(dir_); }

  static TruthObject truthAt(int k) {
    TruthObject car;
    car.frame = k;
    car.t = 0.1 * k;
    car.id = 7;
    car.type = "Van";
    car.position = {18 - 0.5 * k, 1, 0};
    car.length = 4;
    car.width = 2;
    car.height = 1.5;
    car.vx = -5;
    car.vy = 0;
    return car;
  }

  void writeRun(const std::string& name, int first, double shift) {
    ClassTable classes;
    for (const char* c : {"pedestrian", "car"}) {
      classes.classes.emplace_back();
      classes.classes.back().name = c;
    }
    fs::create_directories(dir_ + "/" + name);
    const Stamp start = Stamp::fromSeconds(1.6e9);
    TrackedRunWriter writer(dir_ + "/" + name, classes, start);
    for (int k = 0; k < kFrames; ++k) {
      const TruthObject truth = truthAt(k);
      Scene scene;
      scene.frame = k;
      scene.stamp = start + truth.t;
      if (k >= first) {
        SceneObject car;
        car.id = 1;
        car.class_id = 1;
        car.classified = true;
        car.class_probability = {0.01, 0.99};
        car.existence = 0.9;
        car.position = truth.position + Vector3(shift, 0, 0);
        car.has_yaw = true;
        car.velocity = {-5, 0};
        car.length = 4;
        car.width = 2;
        scene.objects.push_back(car);
      }
      writer.write(scene);
    }
    writer.close();
  }

  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "perception-evaluate");
    std::vector<const char*> argv;
    for (const std::string& a : arguments) argv.push_back(a.c_str());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = runApp(app_, static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return code;
  }
  nlohmann::json report(const std::string& dir) const {
    return nlohmann::json::parse(std::ifstream(dir + "/report.json"));
  }
  std::string truth() const { return dir_ + "/log.truth.csv"; }

  EvaluateApp app_;
  std::string dir_, out_, err_;
};

TEST_F(EvaluateAppTest, TheTruthOfALogOfAnotherNameIsRefusedUnlessTold) {
  RunRecord record;
  record.input = "other.rawlog";
  writeRunRecord(dir_ + "/late/done.json", record);
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 65);
  EXPECT_NE(err_.find("the run is of other.rawlog, whose truth is other.truth.csv"),
            std::string::npos)
      << err_;
  EXPECT_FALSE(fs::exists(dir_ + "/late/evaluation"));
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots", "--any-truth"}), 0) << err_;
  record.input = "log.rawlog";
  writeRunRecord(dir_ + "/late/done.json", record);
  app_.any_truth = false;
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 0) << err_;
}

TEST_F(EvaluateAppTest, TheReportSaysOfWhichRunItIs) {
  RunRecord record;
  record.hash = std::string(64, 'a');
  writeRunRecord(dir_ + "/late/done.json", record);
  ASSERT_EQ(run({"-r", dir_ + "/late", "-t", truth()}), 0) << err_;
  const std::string mark = runMark({record.hash}), folder = dir_ + "/late/evaluation/";
  EXPECT_EQ(report(folder)["runs"][0]["run"], mark);
  std::size_t pictures = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto ending = entry.path().extension();
    if (ending == ".png" || ending == ".txt" || ending == ".md") {
      EXPECT_EQ(runMark(markedRunsOf(entry.path().string())), mark) << entry.path();
      pictures += ending == ".png" ? 1 : 0;
    }
  }
  EXPECT_EQ(pictures > 0, fs::exists("/usr/bin/gnuplot"));
  ASSERT_EQ(run({"-r", dir_ + "/perfect", "-t", truth(), "--no-plots"}), 0) << err_;
  EXPECT_TRUE(report(dir_ + "/perfect/evaluation")["runs"][0]["run"].is_null()) << "not finished";
}

TEST_F(EvaluateAppTest, WritesTheReportBesideTheRun) {
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 0) << err_;
  for (const char* file : {"report.txt", "report.md", "report.json"}) {
    EXPECT_TRUE(fs::exists(dir_ + "/late/evaluation/" + file)) << file;
  }
  EXPECT_NE(out_.find("late: 20 instants"), std::string::npos);
  EXPECT_EQ(std::count(out_.begin(), out_.end(), '\n'), 7) << out_;
  run({"-r", dir_ + "/late", "-t", truth(), "--no-plots", "-v"});
  std::ostringstream text;
  text << std::ifstream(dir_ + "/late/evaluation/report.txt").rdbuf();
  EXPECT_NE(out_.find(text.str()), std::string::npos) << "after the summary";
  const auto figures = report(dir_ + "/late/evaluation")["runs"][0]["closest"]["all"];
  EXPECT_NEAR(figures["object_tracked_a"].get<double>(), 18.0 / 20, 1e-12);
  EXPECT_NEAR(figures["range_rms_m"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(figures["correct"], 1);
  EXPECT_EQ(figures["returns"], 18);
}

TEST_F(EvaluateAppTest, SeveralRunsMakeOneTable) {
  EXPECT_EQ(run({"-r", dir_ + "/late", "-r", dir_ + "/perfect", "-t", truth(), "-o", dir_ + "/out",
                 "--no-plots", "--reference", dir_ + "/perfect"}),
            0)
      << err_;
  const auto runs = report(dir_ + "/out")["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["name"], "late");
  EXPECT_EQ(runs[1]["closest"]["all"]["object_tracked_a"], 1);
  EXPECT_EQ(runs[1]["closest"]["all"]["range_rms_m"], 0);
  EXPECT_NEAR(runs[0]["count_rms"]["all"].get<double>(), std::sqrt(2.0 / 20), 1e-12);
  EXPECT_EQ(runs[1]["count_rms"]["all"], 0);
  EXPECT_TRUE(fs::exists(dir_ + "/out/perfect/report.md"));
}

TEST_F(EvaluateAppTest, TheSameRunGivesTheSameBytes) {
  ASSERT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 0) << err_;
  const auto read = [&] {
    std::ostringstream text;
    text << std::ifstream(dir_ + "/late/evaluation/report.json").rdbuf();
    return text.str();
  };
  const std::string first = read();
  app_ = EvaluateApp();
  ASSERT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 0) << err_;
  EXPECT_EQ(read(), first);
}

TEST_F(EvaluateAppTest, TheTruthOfAnotherLogIsRefusedUnlessToldOtherwise) {
  std::vector<TruthObject> other = {truthAt(0)};
  other[0].frame = 5000;
  other[0].t = 500;
  const std::string file = dir_ + "/other.truth.csv";
  writeGroundTruth(file, other);
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", file, "--no-plots"}),
            static_cast<int>(ExitCode::kBadInput));
  EXPECT_NE(err_.find("no scene has a truth in " + file), std::string::npos) << err_;
  EXPECT_FALSE(fs::exists(dir_ + "/late/evaluation"));
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", file, "--no-plots", "--any-truth"}),
            static_cast<int>(ExitCode::kDataWarnings));
  EXPECT_NE(out_.find("n/a"), std::string::npos);
  EXPECT_TRUE(
      report(dir_ + "/late/evaluation")["runs"][0]["closest"]["all"]["object_tracked_a"].is_null());
}

TEST_F(EvaluateAppTest, RunsOfOneConditionArePooled) {
  fs::create_directories(dir_ + "/t");
  fs::rename(dir_ + "/late", dir_ + "/t/one_L");
  fs::rename(dir_ + "/perfect", dir_ + "/t/two_L");
  EXPECT_EQ(run({"-r", "L+R=" + dir_ + "/t/*_L", "-t", truth(), "-o", dir_ + "/out", "-v",
                 "--no-plots", "--paper", "sunny"}),
            0)
      << err_;
  const auto all = report(dir_ + "/out");
  ASSERT_EQ(all["runs"].size(), 1u);
  EXPECT_EQ(all["runs"][0]["name"], "L+R");
  EXPECT_EQ(all["runs"][0]["closest"]["all"]["active"], 2 * kFrames);
  EXPECT_NEAR(all["runs"][0]["closest"]["all"]["object_tracked_a"].get<double>(),
              (2 * kFrames - 2.0) / (2 * kFrames), 1e-12);
  EXPECT_EQ(all["runs"][0]["trials"].size(), 2u);
  EXPECT_EQ(all["paper"].size(), 3u);
  EXPECT_NE(out_.find("Radecki et al.: L+R, Sunny"), std::string::npos);
  EXPECT_FALSE(fs::exists(dir_ + "/t/one_L/evaluation"));
}

TEST_F(EvaluateAppTest, NoRowOfAnotherWeatherStandsBesideARun) {
  RunRecord record;
  record.simulated = true;
  record.weather = "";  // clear air
  writeRunRecord(dir_ + "/late/done.json", record);
  run({"-r", dir_ + "/late", "-t", truth(), "-v", "--no-plots", "--paper", "snow,sunny"});
  EXPECT_NE(err_.find("--paper snow: no run is of that weather"), std::string::npos) << err_;
  EXPECT_EQ(report(dir_ + "/late/evaluation")["paper"].size(), 3u);
  EXPECT_EQ(out_.find("Snow & Rain"), std::string::npos);
  record.weather = "snow 1 mm/h";
  writeRunRecord(dir_ + "/late/done.json", record);
  run({"-r", dir_ + "/late", "-t", truth(), "-v", "--no-plots", "--paper", "snow"});
  EXPECT_NE(out_.find("Snow & Rain"), std::string::npos);
}

TEST_F(EvaluateAppTest, AManifestNamesConditionsRunsAndTruths) {
  std::ofstream(dir_ + "/runs.csv") << "condition,run,truth\n"
                                       "first,late,log.truth.csv\n"
                                       "second,perfect,log.truth.csv\n"
                                       "second,late,log.truth.csv\n";
  EXPECT_EQ(run({"--manifest", dir_ + "/runs.csv", "-o", dir_ + "/out", "-v", "--no-plots"}), 0)
      << err_;
  const auto runs = report(dir_ + "/out")["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["closest"]["all"]["returns"], 18);
  EXPECT_EQ(runs[1]["closest"]["all"]["returns"], 38);
  EXPECT_NE(out_.find("second: 40 instants"), std::string::npos) << out_;
}

TEST_F(EvaluateAppTest, TheTruthMayBeNamedAfterTheRun) {
  fs::copy(truth(), dir_ + "/late.truth.csv");
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", dir_ + "/{run}.truth.csv", "--no-plots"}), 0) << err_;
}

TEST_F(EvaluateAppTest, WhatCannotBeMeantIsAUsageError) {
  const auto usage = static_cast<int>(ExitCode::kUsage);
  EXPECT_EQ(run({"--manifest", "m.csv", "-t", truth()}), usage);
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-t", truth()}), usage);
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--paper", "moonlight"}), usage);
  EXPECT_NE(err_.find("sunny"), std::string::npos) << err_;
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", "L=" + dir_ + "/late", "-t", truth()}), usage);  // no -o
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", "L=" + dir_ + "/nowhere*", "-t", truth(), "-o", dir_ + "/out"}),
            static_cast<int>(ExitCode::kNoInput));
}

TEST_F(EvaluateAppTest, AFrontEndNeedsRecordedMeasurements) {
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--front-end", "LIDAR"}),
            static_cast<int>(ExitCode::kNoInput));
  EXPECT_NE(err_.find("--measurements"), std::string::npos) << err_;
}

TEST_F(EvaluateAppTest, WithoutATruthItShowsWhatFollowsTheTrueErrorsAndSeedsOfOneLog) {
  RunRecord record;
  record.input = "log.rawlog";
  for (const char* name : {"late", "perfect"}) {
    writeRunRecord(dir_ + "/" + name + "/done.json", record);
    ++record.seed;
  }
  ASSERT_EQ(run({"--without-truth", "-r", dir_ + "/late"}), 0) << err_;
  EXPECT_TRUE(fs::exists(dir_ + "/late/quality/report.md"));
  EXPECT_NE(out_.find("off_velocity"), std::string::npos);
  EXPECT_EQ(out_.find("handovers"), std::string::npos);  // does not follow them
  app_.runs.clear();
  ASSERT_EQ(
      run({"--without-truth", "-r", dir_ + "/late", "-r", dir_ + "/perfect", "-o", dir_ + "/both"}),
      0)
      << err_;
  // The run that begins late lacks the first two scenes of the other one; both are .5 m apart.
  EXPECT_NE(out_.find("| perfect | 1 | 0.000 | 0.000 | 0.100 | n/a | 0.100 | 0.500 |"),
            std::string::npos)
      << out_;
}

TEST_F(EvaluateAppTest, WithATruthAllFiguresStandBesideTheTrueErrors) {
  ASSERT_EQ(run({"--without-truth", "-r", dir_ + "/late", "-t", truth(), "-o", dir_ + "/q"}), 0)
      << err_;
  EXPECT_NE(out_.find("handovers"), std::string::npos);
  EXPECT_NE(out_.find("| late | 0.100 | 0.000 | 0.500 | 0.000 | 0.000 | 0.000 | 0.100 |"),
            std::string::npos)
      << out_;
}

TEST_F(EvaluateAppTest, InstantsAreATable) {
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", truth(), "--no-plots"}), 0) << err_;
  std::ifstream file(dir_ + "/late/evaluation/instants.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), kFrames + 1);
  EXPECT_NE(text.find("\n0,0.000,1,0,1.4142,0.0000,2.0000,0.0000,2.0000,0,0\n"), std::string::npos)
      << text;
}

TEST_F(EvaluateAppTest, FaultsOfTheInputHaveTheirExitCodes) {
  EXPECT_EQ(run({"-r", dir_ + "/late"}), static_cast<int>(ExitCode::kUsage));
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", dir_ + "/none.csv"}),
            static_cast<int>(ExitCode::kNoInput));
  std::ofstream(dir_ + "/bad.csv") << "frame,t\n1,2\n";
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", dir_ + "/late", "-t", dir_ + "/bad.csv"}),
            static_cast<int>(ExitCode::kBadInput));
  EXPECT_NE(err_.find("bad.csv:1: found no column 'id'"), std::string::npos) << err_;
  app_ = EvaluateApp();
  EXPECT_EQ(run({"-r", dir_ + "/nowhere", "-t", truth()}), static_cast<int>(ExitCode::kNoInput))
      << err_;
}

}  // namespace
}  // namespace perception
