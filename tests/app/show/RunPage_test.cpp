#include <gtest/gtest.h>

#include <iostream>
#include <string>
#include <vector>

#include "tests/app/show/RunPageFixture.h"

namespace perception {
namespace {

using namespace test;

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
      "s.host.getBoundingClientRect(); for (const [o, i] of v.run.here(v.k)) { if "
      "(v.run.classes[o.c[i]].muted) continue; const [x, y, z, , , h] = o.row[i], at = "
      "s.toScreen(x, y, z + h / 2); if (!at || at[0] < 20 || at[1] < 60 || at[0] > host.width - 20 "
      "|| at[1] > host.height - 20) continue; if (s.pick(host.left + at[0], host.top + at[1])?.[0] "
      "=== "
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
