#include "libperception/pictures/pages/CompareRuns.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "gui-offscreen/html/HtmlText.h"
#include "libperception/app/show/ReportApp.h"
#include "libperception/pictures/pages/ResultFiles.h"
#include "libperception/pipeline/output/FinishedRun.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

// Two folders of runs of one log: a car for two seconds, and a post beside it.
class CompareRunsTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = testing::TempDir() + "compare <runs> " +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    record_.input = "<street> & co.rawlog";
    record_.config = "site.ini";
    record_.hash = std::string(64, 'a');
    record_.first_stamp = Stamp::fromSeconds(1000);
    record_.last_stamp = Stamp::fromSeconds(1002);
    writeRun("a");
    writeRun("b");
  }
  void TearDown() override { fs::remove_all(dir_); }

  std::string folder(const std::string& name) const { return dir_ + "/" + name; }

  // `change` is called for each scene before it is written.
  template <class Change>
  void writeRun(const std::string& name, Change change) {
    fs::create_directories(folder(name) + "/evaluation");
    ClassTable classes;
    for (const char* class_name : {"car", "static-other"}) {
      classes.classes.emplace_back();
      classes.classes.back().name = class_name;
    }
    TrackedRunWriter writer(folder(name), classes, record_.first_stamp);
    for (int k = 0; k < 20; ++k) {
      Scene scene = sceneAt(k);
      change(k, scene);
      writer.write(scene);
    }
    writer.close();
    writeRunRecord(folder(name) + "/done.json", record_);
    std::ofstream(folder(name) + "/effective.ini") << "[run]\nseed = 1\nsensors = C+L\n";
  }
  void writeRun(const std::string& name) {
    writeRun(name, [](int, Scene&) {});
  }

  static Scene sceneAt(int k) {
    Scene scene;
    scene.stamp = Stamp::fromSeconds(1000) + 0.1 * k;
    SceneObject car;
    car.id = 7;
    car.class_probability = {0.97, 0.03};
    car.classified = true;
    car.position = Vector3(15 + k, 2, 0);
    SceneObject post = car;
    post.id = 8;
    post.class_id = 1;
    post.class_probability = {0.03, 0.97};
    post.position = Vector3(15, 9, 0);
    scene.objects = {car, post};
    return scene;
  }

  int run(std::vector<std::string> options) {
    options.insert(options.begin(), "perception-report");
    std::vector<const char*> argv;
    for (const std::string& option : options) argv.push_back(option.c_str());
    return runApp(app_, static_cast<int>(argv.size()), argv.data());
  }
  int compare(const std::vector<std::string>& more = {}) {
    std::vector<std::string> options = {"--compare", folder("a"), folder("b"), "-o",
                                        dir_ + "/page.html"};
    options.insert(options.end(), more.begin(), more.end());
    return run(options);
  }
  /// The page that was written last; empty: none.
  std::string page() const { return app_.out_path.empty() ? "" : contentsOf(app_.out_path); }
  bool says(const std::string& text) const { return page().find(text) != std::string::npos; }
  std::size_t rows() const {
    const std::string html = page();
    const std::size_t table = html.find("<table id=\"differences\">");
    std::size_t count = 0;
    for (auto at = html.find("<tr data-id", table); at != std::string::npos;
         at = html.find("<tr data-id", at + 1))
      ++count;
    return count;
  }

  std::string dir_;
  RunRecord record_;
  ReportApp app_;
};

TEST_F(CompareRunsTest, IdenticalRunsHaveNoDifference) {
  ASSERT_EQ(compare(), 0);
  EXPECT_TRUE(fs::exists(dir_ + "/page.html"));
  EXPECT_TRUE(says("no difference"));
  EXPECT_TRUE(says("All keys have the same values"));
  EXPECT_TRUE(says(std::string(64, 'a')));
  EXPECT_FALSE(says("<svg"));
  EXPECT_EQ(rows(), 0u);
}

TEST_F(CompareRunsTest, WhatDiffersHasARow) {
  writeRun("b", [](int k, Scene& scene) {
    if (k >= 15) scene.objects[0].id = 9;
    if (k < 4) scene.objects[1].class_id = 0;
  });
  ASSERT_EQ(compare(), 0);
  EXPECT_FALSE(says("no difference"));
  EXPECT_EQ(rows(), 3u);
  EXPECT_TRUE(says("<td>A 7<br><small>also B 9 (5)</small></td><td>B 7</td>"));
  EXPECT_TRUE(says("<td class=\"gone\">no pair</td><td>B 9<br><small>also A 7 (5)</small></td>"));
  EXPECT_TRUE(says("<small>car 4, static-other 16</small>"));
  EXPECT_TRUE(says("B 8: car, 0.0 to 0.4 s</title>"));
  EXPECT_FALSE(says("url(#hatch)")) << "both runs have an object there";
}

TEST_F(CompareRunsTest, AnObjectOfOneRunIsHatched) {
  writeRun("b", [](int, Scene& scene) { scene.objects.pop_back(); });
  ASSERT_EQ(compare(), 0);
  EXPECT_EQ(rows(), 1u);
  EXPECT_TRUE(says("<td>A 8</td><td class=\"gone\">only in A</td>"));
  EXPECT_TRUE(says("fill=\"url(#hatch)\""));
}

TEST_F(CompareRunsTest, KeysAndFiguresStandSideBySide) {
  std::ofstream(folder("b") + "/effective.ini") << "[run]\nseed = 2\nsensors = C+L\nnew = <b>\n";
  for (const char* name : {"a", "b"})
    std::ofstream(folder(name) + "/evaluation/report.json")
        << R"({"runs":[{"run":")" << runMark({idOfRun(record_)}) << R"(","identities":{"mota":0.)"
        << (*name == 'a' ? 5 : 6) << "}}]}";
  ASSERT_EQ(compare(), 0);
  EXPECT_TRUE(says("<tr><td>run.seed</td><td><b>1</b></td><td><b>2</b></td></tr>"));
  EXPECT_TRUE(says("<td>run.new</td><td><b></b></td><td><b>&lt;b&gt;</b></td>"));
  EXPECT_FALSE(says("<td>run.sensors</td>"));
  EXPECT_TRUE(says("<td>MOTA</td><td><b>0.500</b></td><td><b>0.600</b></td>"));
  fs::remove(folder("b") + "/effective.ini");
  ASSERT_EQ(compare(), 0);
  EXPECT_TRUE(says("has no effective.ini"));
}

TEST_F(CompareRunsTest, TheFilmOfBothIsInThePageAndThatOfOthersIsRefused) {
  record_.hash = std::string(64, 'b');
  writeRun("b");
  const std::string a = markOfRuns({folder("a")}), b = markOfRuns({folder("b")});
  ASSERT_NE(a, b);
  ASSERT_EQ(compare(), 0);
  EXPECT_TRUE(says("perception-snapshot -r ")) << "how the film is made";
  EXPECT_EQ(markedRunsOf(app_.out_path).size(), 2u) << "the page says of which runs it is";
  const std::string film = dir_ + "/both.mp4";
  std::ofstream(film) << "film " << a << b;
  ASSERT_EQ(compare({"--film", film}), 0);
  EXPECT_TRUE(says("data:video/mp4;base64," + base64("film " + a + b)));
  std::ofstream(film) << a;
  EXPECT_EQ(compare({"--film", film}), 65) << "of one alone";
  std::ofstream(film) << "unmarked";
  EXPECT_EQ(compare({"--film", film}), 65);
  EXPECT_EQ(compare({"--film", dir_ + "/none.mp4"}), 66);
}

TEST_F(CompareRunsTest, NamesAreNoMarkupAndNothingIsLoaded) {
  ASSERT_EQ(compare(), 0);
  EXPECT_TRUE(says("&lt;street&gt; &amp; co.rawlog"));
  EXPECT_FALSE(says("<street>"));
  EXPECT_FALSE(says("<runs>"));
  for (const char* text : {"src=\"http", "href=", "@import"}) EXPECT_FALSE(says(text)) << text;
}

TEST_F(CompareRunsTest, RunsOfDifferentLogsAreRefused) {
  record_.input = "other.rawlog";
  writeRun("b");
  EXPECT_EQ(compare(), 65);
  try {
    readComparison(folder("a"), folder("b"));
    FAIL();
  } catch (const DataError& error) {
    const std::string message = error.what();
    for (const std::string& name : {folder("a"), folder("b")})
      EXPECT_NE(message.find(name), std::string::npos) << message;
    EXPECT_NE(message.find("other.rawlog"), std::string::npos) << message;
  }
  EXPECT_FALSE(fs::exists(dir_ + "/page.html"));
}

TEST_F(CompareRunsTest, LogsOfOneNameThatDoNotOverlapAreRefused) {
  record_.first_stamp = Stamp::fromSeconds(2000);
  record_.last_stamp = Stamp::fromSeconds(2002);
  writeRun("b", [](int, Scene& scene) { scene.stamp = scene.stamp + 1000; });
  EXPECT_EQ(compare(), 65);
  record_.first_stamp = Stamp::fromSeconds(1000);  // the logs overlap, the scenes do not
  writeRun("b", [](int, Scene& scene) { scene.stamp = scene.stamp + 1000; });
  EXPECT_EQ(compare(), 65);
}

TEST_F(CompareRunsTest, OptionsThatDoNotFitAreRefused) {
  EXPECT_EQ(run({"--compare", folder("a"), folder("b")}), 64);
  EXPECT_EQ(run({"--compare", folder("a"), "-o", dir_ + "/page.html"}), 64);
  app_ = ReportApp();
  EXPECT_EQ(run({"-o", dir_ + "/page.html"}), 64);
  EXPECT_EQ(run({"-r", folder("a"), "--compare", folder("a"), folder("b"), "-o", dir_ + "/page"}),
            64);
  app_ = ReportApp();
  fs::remove(folder("b") + "/done.json");
  EXPECT_EQ(compare(), 66);
}

}  // namespace
}  // namespace perception
