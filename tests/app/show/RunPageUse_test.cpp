#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/app/show/RunPageFixture.h"

namespace perception {
namespace {

using namespace test;

TEST_F(OwnRunPage, TheAddressLeadsToAnInstantAndAnObject) {
  open(900, 700, page_ + "#t=1.2&id=2");
  EXPECT_EQ(scene(), 12);
  EXPECT_EQ(value("perceptionViewers[0].id"), 2);
  EXPECT_EQ(value("document.querySelector('.say').hidden"), true);
}

TEST_F(OwnRunPage, TheAddressFollowsWhatIsDone) {
  browser_->press("ArrowRight");
  browser_->press("n");
  browser_->waitFor("location.hash === '#t=0.1&id=1'");
  browser_->press("Escape");
  browser_->waitFor("location.hash === '#t=0.1'");
}

TEST_F(OwnRunPage, AWrongAddressIsToldAndOpensAtTheStart) {
  const std::pair<const char*, const char*> wrong[] = {{"#t=soon", "t=soon"},
                                                       {"#t=99&id=1", "t=99"},
                                                       {"#t=1&id=77", "id=77"},
                                                       {"#when=1", "when"},
                                                       {"#t=1&run=c", "run=c"}};
  for (const auto& [address, named] : wrong) {
    value("perceptionViewers[0].seek(2)");
    value(std::string("location.hash = '") + address + "'");
    browser_->waitFor(std::string("document.querySelector('.say').textContent.includes('") + named +
                      "')");
    EXPECT_EQ(scene(), 0) << address;
    EXPECT_TRUE(value("perceptionViewers[0].id").is_null()) << address;
    EXPECT_EQ(value("document.querySelector('.say').hidden"), false) << address;
  }
  open(900, 700, page_ + "#t=99");
  EXPECT_EQ(scene(), 0);
  EXPECT_NE(text(".say").find("t=99"), std::string::npos) << text(".say");
}

TEST_F(OwnRunPage, AnAddressTypedWhileAnotherIsAboutToBeWrittenIsFollowed) {
  value("perceptionViewers[0].seek(2)");
  browser_->waitFor("location.hash === '#t=2'");
  // The page writes the new instant a little later, here after the address and before its event.
  value(R"((() => {
    const wait = window.setTimeout, due = [];
    window.setTimeout = (write) => due.push(write);
    perceptionViewers[0].seek(1);
    window.setTimeout = wait;
    location.hash = '#t=soon';
    for (const write of due) write();
    return due.length;
  })())");
  browser_->waitFor("document.querySelector('.say').textContent.includes('t=soon')");
}

TEST_F(OwnRunPage, LayersAndLookAreRemembered) {
  value("document.querySelector('input[name=points]').click()");
  const std::string before = value("document.documentElement.dataset.look");
  value("document.querySelector('.look').click()");
  open(900, 700);
  EXPECT_EQ(value("document.querySelector('input[name=points]').checked"), false);
  EXPECT_NE(value("document.documentElement.dataset.look"), before);
  value("localStorage.clear()");
  open(900, 700);
  EXPECT_EQ(value("document.querySelector('input[name=points]').checked"), true);
}

TEST_F(OwnRunPage, WithoutStorageTheWindowRemembers) {
  value("void Object.defineProperty(window, 'localStorage', {get() { throw new Error('none'); }})");
  value("document.querySelector('input[name=grid]').click()");
  EXPECT_NE(value("window.name").get<std::string>().find("\"grid\":true"), std::string::npos);
  EXPECT_EQ(browser_->faults(), std::vector<std::string>{});
}

TEST_F(OwnRunPage, ThePageIsDrawnAtMostTwiceWhenItOpens) {
  const int drawn = value("perceptionViewers[0].space.renderer.info.render.frame");
  EXPECT_GE(drawn, 1);
  EXPECT_LE(drawn, 2) << "a scroll bar may narrow the page once it is filled";
}

TEST_F(OwnRunPage, EventsAreUnpackedWhenTheirListIsOpened) {
  EXPECT_EQ(text("#events summary").substr(0, 8), "2 events");
  EXPECT_EQ(value("document.querySelectorAll('#events tr').length"), 0);
  value("document.querySelector('#events details').open = true");
  browser_->waitFor("document.querySelectorAll('#events tr').length === 3");
  EXPECT_EQ(text("#events tr.warning").substr(0, 19), "1.50 ssensor blindL");
  EXPECT_EQ(value("document.querySelectorAll('#events option').length"), 3);
  value("document.querySelector('#events tr.warning').click()");
  EXPECT_EQ(scene(), 15);
}

TEST_F(OwnRunPage, AKeyShowsTheKeys) {
  browser_->press("?");
  EXPECT_EQ(value("document.querySelector('dialog.help').open"), true);
  EXPECT_NE(text("dialog.help").find("next, previous object"), std::string::npos);
  browser_->press("?");
  EXPECT_EQ(value("document.querySelector('dialog.help').open"), false);
}

// WCAG 2.1: 4.5 for text, 3 for what is drawn.
TEST_F(OwnRunPage, ColorsStandOutInBothLooks) {
  for (const char* look : {"light", "dark"}) {
    value(std::string("localStorage.setItem('perception.page', '{\"look\":\"") + look + "\"}')");
    open(900, 700);
    EXPECT_EQ(value("document.documentElement.dataset.look"), look);
    const auto least = value(
        "(() => { const c = perceptionColors, v = perceptionViewers[0], paper = "
        "c.parse(getComputedStyle(document.body).backgroundColor), all = v.run.classes.map((k) => "
        "c.parse(k.color)); return {paper: c.contrast(paper, c.look.paper), text: "
        "Math.min(...all.map((k) => c.contrast(c.text(k), paper)), "
        "...[...document.querySelectorAll('h1, p, td, td span, label, .clock, aside dt')].map((e) "
        "=> c.contrast(c.parse(getComputedStyle(e).color), paper))), line: "
        "Math.min(...[...all, c.PHANTOM, c.MEASUREMENT, c.RADAR, c.FREE, c.STOP].map((k) => "
        "c.contrast(c.line(k), paper)))}; })()");
    EXPECT_DOUBLE_EQ(least["paper"].get<double>(), 1) << "the canvas has the page's paper";
    EXPECT_GE(least["text"].get<double>(), 4.5) << look;
    EXPECT_GE(least["line"].get<double>(), 3) << look;
    keep(std::string("page-") + look + ".png");
  }
  value("localStorage.clear()");
}

TEST_F(OwnRunPage, AnObjectShowsItsErrorsAgainstTheTruth) {
  open(900, 700, page_ + "#t=1&id=1");
  const std::string panel = text(".object");
  EXPECT_NE(panel.find("object 5; 30 of 30 instants"), std::string::npos) << panel;
  EXPECT_NE(panel.find("1.00 m off, speed −3.6 km/h"), std::string::npos) << panel;
  EXPECT_NE(panel.find("class right"), std::string::npos) << panel;
  keep("page-truth.png");
  open(900, 700, page_ + "#t=1&id=2");
  EXPECT_NE(text(".object").find("No object of the truth was matched"), std::string::npos);
}

TEST_F(OwnRunPage, TwoRunsAreInOneViewSwitchedOrOverlaid) {
  open(1400, 900, both_ + "#t=1&id=11&run=b");
  EXPECT_EQ(value("document.querySelectorAll('.space canvas').length"), 2) << "one view";
  EXPECT_EQ(text(".object h3").rfind("B 11 ", 0), 0u) << text(".object h3");
  EXPECT_EQ(value("perceptionViewers[0].space.boxes.length"), 4);
  keep("page-both.png");
  browser_->press("c");
  EXPECT_EQ(value("perceptionViewers[0].shown"), "a");
  EXPECT_EQ(value("perceptionViewers[0].space.boxes").dump(), "[[1,0],[2,0]]");
  browser_->press("c");
  EXPECT_EQ(value("perceptionViewers[0].space.boxes").dump(), "[[2,1],[11,1]]");
  value("document.querySelector('tr[data-of=a]').click()");
  EXPECT_EQ(value("perceptionViewers[0].of"), 0) << "a row of the table leads to its run";
  EXPECT_EQ(browser_->requests(), std::vector<std::string>{});
  EXPECT_EQ(browser_->faults(), std::vector<std::string>{});
}

}  // namespace
}  // namespace perception
