#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "libperception/app/show/ReportApp.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/scene/files/RunRecord.h"
#include "tests/app/DemoLog.h"
#include "tests/support/Browser.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

inline constexpr int kRunScenes = 30;

/// A run of three seconds of the demo log: a car ahead and a person beside it, and rain. The car is
/// number `car_id`; another one than 1 is half a meter farther to the left.
inline void writeRun(const std::string& dir, std::uint64_t car_id = 1) {
  std::filesystem::create_directories(dir);
  ClassTable classes;
  for (const char* name : {"pedestrian", "car"}) {
    classes.classes.emplace_back();
    classes.classes.back().name = name;
  }
  TrackedRunWriter writer(dir, classes, Stamp::fromSeconds(kDemoFirstStamp));
  for (int k = 0; k < kRunScenes; ++k) {
    Scene scene;
    scene.stamp = scene.ego.stamp = Stamp::fromSeconds(kDemoFirstStamp) + 0.1 * k;
    scene.frame = k;
    SceneObject car;
    car.id = car_id;
    car.class_id = 1;
    car.class_probability = {0.02, 0.98};
    car.classified = true;
    car.existence = 0.99;
    car.position = Vector3(15 - 0.1 * k, car_id == 1 ? 2 : 2.5, 0);
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
  for (int k = 0; k < kRunScenes; ++k)
    weather << 0.1 * k << ',' << kDemoFirstStamp + 0.1 * k
            << ",LIDAR_TOP,rain,0.1,0.8,0.05,0.05,9,7,11,1,0,2,900,700,1200,1000,50,0\n";
  std::ofstream(dir + "/events.jsonl")
      << R"({"t":0.0,"kind":"track_born","severity":"info","message":"object 1","fields":{"id":1}})"
      << "\n"
      << R"({"t":1.5,"kind":"sensor_blind","severity":"warning","message":"LIDAR_TOP"})"
      << "\n";
  RunRecord record;
  record.input = "demo.rawlog";
  record.simulated = true;
  writeRunRecord(dir + "/done.json", record);
}

/// A car and a person as the tracker has them: the car a meter too far, named right; no person.
inline void writeTruth(const std::string& file) {
  std::vector<TruthObject> rows;
  for (int k = 0; k < kRunScenes; ++k) {
    TruthObject car;
    car.frame = k;
    car.t = 0.1 * k;
    car.id = 5;
    car.type = "Car";
    car.position = Vector3(14 - 0.1 * k, 2, 0);
    car.length = 4, car.width = 2, car.height = 1.5;
    car.vx = -2, car.vy = 0;
    car.lidar_points = 100;
    rows.push_back(car);
  }
  writeGroundTruth(file, rows);
}

/// The page of a run in a browser; PERCEPTION_PAGE names another one, PERCEPTION_SCREENSHOTS a
/// folder for pictures of it.
class RunPage : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (Browser::program().empty()) return;
    folder_ = std::make_unique<TemporaryFolder>();
    if (const char* other = std::getenv("PERCEPTION_PAGE")) {
      page_ = other;
    } else {
      writeRun(*folder_ / "run");
      writeRun(*folder_ / "other", 11);
      writeTruth(*folder_ / "truth.csv");
      page_ = *folder_ / "run/index.html";
      both_ = *folder_ / "both.html";
      const std::string run = *folder_ / "run", changed = *folder_ / "other",
                        truth = *folder_ / "truth.csv";
      ReportApp app, comparison;
      const char* argv[] = {"perception-report", "-r", run.c_str(),  "-i",
                            kDemoLog.c_str(),    "-t", truth.c_str()};
      ASSERT_EQ(runApp(app, 7, argv), 0);
      const char* two[] = {"perception-report", "--compare", run.c_str(),  changed.c_str(), "-i",
                           kDemoLog.c_str(),    "-o",        both_.c_str()};
      ASSERT_EQ(runApp(comparison, 8, two), 0);
    }
    browser_ = std::make_unique<Browser>();
  }
  static void TearDownTestSuite() {
    browser_.reset();
    folder_.reset();
  }
  void SetUp() override {
    if (!browser_) GTEST_SKIP() << "missing tool: chromium";
    open(1400, 1000);
  }

  static void open(int width, int height, const std::string& address = page_) {
    browser_->resize(width, height);
    browser_->open(address);
    browser_->waitFor("!!document.querySelector('[data-run][data-ready]')");
  }
  static nlohmann::json value(const std::string& expression) { return browser_->value(expression); }
  static int scene() { return value("perceptionViewers[0].k"); }
  static int scenes() { return value("perceptionViewers[0].run.times.length"); }
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

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<Browser> browser_;
  static inline std::string page_, both_;
};

/// Those of the page that the test wrote itself.
class OwnRunPage : public RunPage {
 protected:
  void SetUp() override {
    if (!browser_) GTEST_SKIP() << "missing tool: chromium";
    if (both_.empty()) GTEST_SKIP() << "another page is named by PERCEPTION_PAGE";
    open(900, 700);
  }
  static std::string text(const std::string& selector) {
    return value("document.querySelector('" + selector + "').textContent");
  }
};

}  // namespace perception::test
