#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>

#include "libperception/app/show/ReportApp.h"
#include "libperception/scene/files/RunRecord.h"
#include "tests/app/DemoLog.h"
#include "tests/support/Browser.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

using namespace test;

constexpr int kScenes = 30;

/// A run of three seconds of the demo log: a car ahead and a person beside it, and rain.
void writeRun(const std::string& dir) {
  std::filesystem::create_directories(dir);
  ClassTable classes;
  for (const char* name : {"pedestrian", "car"}) {
    classes.classes.emplace_back();
    classes.classes.back().name = name;
  }
  TrackedRunWriter writer(dir, classes, Stamp::fromSeconds(kDemoFirstStamp));
  for (int k = 0; k < kScenes; ++k) {
    Scene scene;
    scene.stamp = scene.ego.stamp = Stamp::fromSeconds(kDemoFirstStamp) + 0.1 * k;
    scene.frame = k;
    SceneObject car;
    car.id = 1;
    car.class_id = 1;
    car.class_probability = {0.02, 0.98};
    car.classified = true;
    car.existence = 0.99;
    car.position = Vector3(15 - 0.1 * k, 2, 0);
    car.velocity = Vector2(-1, 0);
    car.length = 4, car.width = 2, car.height = 1.5;
    SceneObject person = car;
    person.id = 2;
    person.class_id = 0;
    person.class_probability = {0.98, 0.02};
    person.position.y() = -4;
    person.length = person.width = 0.6;
    scene.objects = {car, person};
    writer.write(scene);
  }
  writer.close();
  std::ofstream weather(dir + "/weather.csv");
  weather
      << "t,stamp,sensor,type,p_clear,p_rain,p_snow,p_fog,rain,rain_low,rain_high,snow,snow_low,"
         "snow_high,visibility,visibility_low,visibility_high,returns,doubted,mirrored\n";
  for (int k = 0; k < kScenes; ++k)
    weather << 0.1 * k << ',' << kDemoFirstStamp + 0.1 * k
            << ",LIDAR_TOP,rain,0.1,0.8,0.05,0.05,9,7,11,1,0,2,900,700,1200,1000,50,0\n";
  RunRecord record;
  record.input = "demo.rawlog";
  record.simulated = true;
  writeRunRecord(dir + "/done.json", record);
}

/// The page of a run in a browser; PERCEPTION_PAGE names another one, PERCEPTION_SCREENSHOTS a
/// folder for pictures of it.
class RunPage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (test::Browser::program().empty()) return;
    folder_ = std::make_unique<test::TemporaryFolder>();
    if (const char* other = std::getenv("PERCEPTION_PAGE")) {
      page_ = other;
    } else {
      writeRun(*folder_ / "run");
      page_ = *folder_ / "run/index.html";
      ReportApp app;
      const std::string run = *folder_ / "run";
      const char* argv[] = {"perception-report", "-r", run.c_str(), "-i", kDemoLog.c_str()};
      ASSERT_EQ(runApp(app, 5, argv), 0);
    }
    browser_ = std::make_unique<test::Browser>();
  }
  static void TearDownTestSuite() {
    browser_.reset();
    folder_.reset();
  }
  void SetUp() override {
    if (!browser_) GTEST_SKIP() << "missing tool: chromium";
    open(1400, 1000);
  }

  static void open(int width, int height) {
    browser_->resize(width, height);
    browser_->open(page_);
    browser_->waitFor("!!document.querySelector('[data-run][data-ready]')");
  }
  static nlohmann::json value(const std::string& expression) { return browser_->value(expression); }
  static int scene() { return value("perceptionViewers[0].k"); }
  static int scenes() { return value("perceptionViewers[0].run.scenes.length"); }
  /// Pixels of the space that are not paper.
  static int ink() {
    return value(
        "(() => { const c = document.querySelector('.space canvas'), s = "
        "document.createElement('canvas'); s.width = c.width; s.height = c.height; const pen = "
        "s.getContext('2d'); pen.drawImage(c, 0, 0); const d = pen.getImageData(0, 0, s.width, "
        "s.height).data; let n = 0; for (let i = 0; i < d.length; i += 4) if (d[i] + d[i + 1] + "
        "d[i + 2] < 740) ++n; return n; })()");
  }
  static nlohmann::json middleOf(const std::string& selector) {
    return value("(() => { const e = document.querySelector('" + selector +
                 "'); e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
                 "return {x: b.x, y: b.y + b.height / 2, width: b.width}; })()");
  }
  static void keep(const std::string& name) {
    if (const char* dir = std::getenv("PERCEPTION_SCREENSHOTS"))
      browser_->screenshot(std::string(dir) + "/" + name);
  }

  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline std::unique_ptr<test::Browser> browser_;
  static inline std::string page_;
};

TEST_F(RunPage, DrawsTheSpaceWithoutNetworkAndWithoutAFault) {
  EXPECT_GT(ink(), 2000);
  EXPECT_EQ(browser_->requests(), std::vector<std::string>{});
  EXPECT_EQ(browser_->faults(), std::vector<std::string>{});
  std::cout << "first paint after "
            << value(
                   "Math.round(performance.getEntriesByName('first-contentful-paint')[0]?"
                   ".startTime)")
            << " ms\n";
  keep("page-1400.png");
}

TEST_F(RunPage, AClickOnABoxChoosesItsObject) {
  value("perceptionViewers[0].seek(perceptionViewers[0].run.times.at(-1) / 2)");
  value("document.querySelector('.stage').scrollIntoView({block: 'center'})");
  // The middle of a box that nothing covers.
  const auto spot = value(
      "(() => { const v = perceptionViewers[0], s = v.space, host = "
      "s.host.getBoundingClientRect(); for (const [o, i] of v.run.present[v.k]) { if "
      "(v.run.classes[o.c[i]].muted) continue; const [x, y, z, , , h] = o.row[i], at = "
      "s.toScreen(x, y, z + h / 2); if (!at || at[0] < 20 || at[1] < 60 || at[0] > host.width - 20 "
      "|| at[1] > host.height - 20) continue; if (s.pick(host.left + at[0], host.top + at[1]) === "
      "o.id) return {x: host.left + at[0], y: host.top + at[1], id: o.id}; } return null; })()");
  ASSERT_FALSE(spot.is_null()) << "no object is in the picture";
  browser_->click(spot["x"], spot["y"]);
  EXPECT_EQ(value("perceptionViewers[0].id"), spot["id"]);
  const std::string title = value("document.querySelector('.object h3').textContent");
  EXPECT_EQ(title.rfind(spot["id"].dump() + " ", 0), 0u) << title;
  EXPECT_GE(value("document.querySelectorAll('.object canvas').length"), 3)
      << "class, speed, existence";
  keep("page-object.png");
}

TEST_F(RunPage, TheSliderGoesToATime) {
  ASSERT_EQ(scene(), 0);
  const auto slider = middleOf(".transport input");
  const double x = slider["x"], y = slider["y"], width = slider["width"];
  browser_->drag(x + 8, y, x + width / 2, y);
  EXPECT_NEAR(scene(), scenes() / 2.0, 0.1 * scenes());
}

TEST_F(RunPage, LayersAreSwitchedByTheirBoxes) {
  const int before = ink();
  value("document.querySelector('input[name=points]').click()");
  EXPECT_LT(ink(), before);
  value("document.querySelector('input[name=points]').click()");
  EXPECT_EQ(ink(), before);
}

TEST_F(RunPage, KeysStepPlayAndChoose) {
  browser_->press("ArrowRight");
  EXPECT_EQ(scene(), 1);
  value("document.querySelector('.rate').value = '0.25'");  // no end while the machine is busy
  browser_->press(" ");
  EXPECT_EQ(value("perceptionViewers[0].playing"), true);
  browser_->waitFor("perceptionViewers[0].k > 2");
  browser_->press(" ");
  EXPECT_EQ(value("perceptionViewers[0].playing"), false);
  browser_->press("n");
  EXPECT_TRUE(value("perceptionViewers[0].id").is_number());
  browser_->press("Escape");
  EXPECT_TRUE(value("perceptionViewers[0].id").is_null());
}

TEST_F(RunPage, TheWeatherIsDrawnOverTimeAndLeadsThere) {
  if (value("perceptionViewers[0].run.weather.length") == 0) GTEST_SKIP() << "a run without";
  EXPECT_GE(value("document.querySelectorAll('#weather canvas').length"), 3);
  const auto chart = middleOf("#weather .u-over");
  browser_->click(chart["x"].get<double>() + 0.75 * chart["width"].get<double>(), chart["y"]);
  EXPECT_NEAR(scene(), 0.75 * scenes(), 0.1 * scenes());
  EXPECT_EQ(browser_->faults(), std::vector<std::string>{});
}

TEST_F(RunPage, FitsAPhone) {
  open(390, 844);
  EXPECT_GT(ink(), 1000);
  EXPECT_LE(value("document.documentElement.scrollWidth"), 390);
  EXPECT_EQ(browser_->faults(), std::vector<std::string>{});
  keep("page-390.png");
}

}  // namespace
}  // namespace perception
