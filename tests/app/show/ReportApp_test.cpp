#include "libperception/app/show/ReportApp.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "gui-offscreen/html/HtmlText.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/RunMark.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

// Two seconds of a car that is surely one from the second half on, and a post.
class ReportAppTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "report app " +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_ + "/evaluation");
    ClassTable classes;
    for (const char* name : {"car", "static-other"}) {
      classes.classes.emplace_back();
      classes.classes.back().name = name;
    }
    TrackedRunWriter writer(dir_, classes, Stamp::fromSeconds(1000));
    for (int k = 0; k < 20; ++k) writer.write(sceneAt(k));
    writer.close();
    RunRecord record;
    record.input = "<street> & co.rawlog";
    record.simulated = true;
    writeRunRecord(dir_ + "/done.json", record);
    mark_ = runMark({idOfRun(record)});
  }
  void TearDown() override { fs::remove_all(dir_); }

  static Scene sceneAt(int k) {
    Scene scene;
    scene.stamp = Stamp::fromSeconds(1000) + 0.1 * k;
    SceneObject car;
    car.id = 7;
    car.class_probability = {0.9, 0.1};
    car.classified = k >= 10;
    car.position = Vector3(15, 2, 0);
    car.velocity = Vector2(10, 0);
    SceneObject post = car;
    post.id = 8;
    post.class_id = 1;
    scene.objects = {car, post};
    return scene;
  }

  int run(std::vector<std::string> options = {}) {
    options.insert(options.begin(), {"perception-report", "-r", dir_});
    std::vector<const char*> argv;
    for (const std::string& option : options) argv.push_back(option.c_str());
    return runApp(app_, static_cast<int>(argv.size()), argv.data());
  }
  /// The page that was written last; empty: none.
  std::string page() const { return app_.out_path.empty() ? "" : contentsOf(app_.out_path); }
  bool says(const std::string& text) const { return page().find(text) != std::string::npos; }

  std::string dir_, mark_;
  ReportApp app_;
};

TEST_F(ReportAppTest, TellsTheRoadUsersAndCallsASimulatedRunSimulated) {
  ASSERT_EQ(run(), 0);
  EXPECT_TRUE(fs::exists(dir_ + "/index.html"));
  EXPECT_TRUE(says("<b>simulated</b>"));
  EXPECT_TRUE(says(">7 car</text>"));
  EXPECT_FALSE(says(">8 static-other</text>")) << "posts are counted, not listed";
  EXPECT_TRUE(says("7: probably car, 0.0 to 1.0 s"));
  EXPECT_TRUE(says("7: car, 1.0 to 2.0 s"));
  EXPECT_TRUE(says("<td>36 km/h</td>"));
}

TEST_F(ReportAppTest, NamesOfFilesAreNoMarkup) {
  ASSERT_EQ(run(), 0);
  EXPECT_TRUE(says("&lt;street&gt; &amp; co.rawlog"));
  EXPECT_FALSE(says("<street>"));
}

TEST_F(ReportAppTest, HoldsEveryFileInsideAndNoAddress) {
  std::ofstream(dir_ + "/scene.png") << "picture" << mark_;
  std::ofstream(dir_ + "/scene.mp4") << "film" << mark_;
  ASSERT_EQ(run({"-o", dir_ + "/page.html"}), 0);
  EXPECT_TRUE(says("data:image/png;base64," + base64("picture" + mark_)));
  EXPECT_TRUE(says("data:video/mp4;base64," + base64("film" + mark_)));
  EXPECT_FALSE(says("src=\"http"));
  EXPECT_FALSE(says("<link"));
  EXPECT_FALSE(says("@import"));
  EXPECT_TRUE(fs::exists(dir_ + "/page.html"));
}

TEST_F(ReportAppTest, FiguresOfTheEvaluationStandInTheTable) {
  std::ofstream(dir_ + "/evaluation/report.json")
      << R"({"options":{"range_m":20.0},"runs":[{"run":")" << mark_
      << R"(","closest":{"all":{"object_tracked_a":0.75,)"
      << R"("correct":null,"active":8},"classes":{}}}]})";
  ASSERT_EQ(run(), 0);
  EXPECT_TRUE(says("<b>75.0 %</b>"));
  EXPECT_TRUE(says("<td>n/a</td>"));
  std::ofstream(dir_ + "/evaluation/report.json") << "{";
  EXPECT_EQ(run(), 65);
}

TEST_F(ReportAppTest, ProductsOfAnotherRunAreRefusedAndThoseOfNoneLeftOut) {
  const std::string other = runMark({std::string(64, 'b')});
  for (const char* name : {"scene.png", "contact.png", "scene.mp4", "evaluation/report.json"}) {
    const bool figures = fs::path(name).extension() == ".json";
    const auto write = [&](const std::string& mark) {
      std::ofstream(dir_ + "/" + name)
          << (figures ? R"({"runs":[{"run":")" + mark + R"(","closest":{}}]})" : mark);
    };
    write(other);
    testing::internal::CaptureStderr();
    EXPECT_EQ(run(), 65) << name;
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(name), std::string::npos) << said;
    EXPECT_NE(said.find("is of run " + std::string(64, 'b')), std::string::npos) << said;
    EXPECT_FALSE(fs::exists(dir_ + "/index.html"));
    write("");
    EXPECT_EQ(run(), 3) << "left out with a warning";
    EXPECT_FALSE(says("<figure>") || says("<h2>Against the truth"));
    fs::remove(dir_ + "/index.html");
    write(mark_);
    EXPECT_EQ(run(), 0) << name;
    EXPECT_TRUE(says("<figure>") || says("<h2>Against the truth"));
    fs::remove(dir_ + "/" + name);
    fs::remove(dir_ + "/index.html");
  }
}

TEST_F(ReportAppTest, PicturesOfAnyNameThatAreOfTheRunAreShown) {
  std::ofstream(dir_ + "/frame50.png") << "picture" << mark_;
  std::ofstream(dir_ + "/holiday.png") << "picture";
  std::ofstream(dir_ + "/other.png") << runMark({std::string(64, 'b')});
  testing::internal::CaptureStdout();
  ASSERT_EQ(run(), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), dir_ + "/index.html\n") << "says what it wrote";
  EXPECT_TRUE(says("<h2>frame50.png</h2>"));
  EXPECT_FALSE(says("holiday.png") || says("other.png"));
}

TEST_F(ReportAppTest, ThePageSaysOfWhichRunItIs) {
  ASSERT_EQ(run(), 0);
  EXPECT_EQ(runMark(markedRunsOf(dir_ + "/index.html")), mark_);
}

TEST_F(ReportAppTest, OfSeveralRunsInAnEvaluationThePageShowsItsOwn) {
  std::ofstream(dir_ + "/evaluation/report.json")
      << R"({"runs":[{"run":")" << runMark({std::string(64, 'b')})
      << R"(","closest":{"all":{"object_tracked_a":0.1}}},{"run":")" << mark_
      << R"(","closest":{"all":{"object_tracked_a":0.75}}}]})";
  ASSERT_EQ(run(), 0);
  EXPECT_TRUE(says("<b>75.0 %</b>"));
}

TEST_F(ReportAppTest, MissingFilesAreSaidByExitCode) {
  EXPECT_EQ(run({"--evaluation", dir_ + "/nowhere"}), 66);
  fs::remove(dir_ + "/done.json");
  EXPECT_EQ(run(), 66);
}

TEST_F(ReportAppTest, RefusesTheLogOfAnotherRun) {
  std::ofstream(dir_ + "/other.rawlog") << "x";
  EXPECT_EQ(run({"-i", dir_ + "/other.rawlog"}), 65);
}

TEST(Base64, IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

}  // namespace
}  // namespace perception
