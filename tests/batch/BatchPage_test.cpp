#include "libperception/batch/BatchPage.h"

#include "tests/batch/BatchFixture.h"
#include "tests/support/Browser.h"

namespace perception::test {
namespace {

/// Three shards, all done, of which two have a figure.
class BatchPageTest : public BatchFixture {
 protected:
  void SetUp() override {
    if (Browser::program().empty()) GTEST_SKIP() << "missing tool: chromium";
    results.figures = {"closest.all.object_tracked_a"};
    for (const char* id : {"aaa", "bbb", "ccc"}) {
      const Shard& shard = addShard(id);
      finish(shard, recordOf(shard));
      results.shards.push_back({shard, statusOf(shard, dir), {}, ""});
    }
    results.shards[0].figures = {{results.figures[0], 0.9}};
    results.shards[1].figures = {{results.figures[0], 0.4}};
  }
  void open() {
    std::ofstream(dir + "/index.html") << batchPage(batch, results, dir);
    browser.emplace();
    browser->resize(1400, 900);
    browser->open(dir + "/index.html");
  }
  std::string ids() {
    return browser->value(
        "[...document.querySelectorAll('#shards td.id')].map((c) => c.textContent).join(' ')");
  }
  void sortBy(const std::string& name) {
    browser->value(
        "[...document.querySelectorAll('#shards th')].find((c) => c.textContent"
        ".startsWith('" +
        name + "')).click()");
  }

  BatchResults results;
  std::optional<Browser> browser;
};

TEST_F(BatchPageTest, AClickOnAHeadingSortsAndShardsWithoutTheFigureAreLast) {
  open();
  EXPECT_EQ(ids(), "aaa bbb ccc");
  sortBy("tracked");
  EXPECT_EQ(ids(), "aaa bbb ccc") << "figures: the largest first";
  sortBy("tracked");
  EXPECT_EQ(ids(), "bbb aaa ccc");
  browser->value(
      "(() => { const f = document.getElementById('filter'); f.value = 'bbb'; "
      "f.dispatchEvent(new Event('input')); })()");
  EXPECT_EQ(ids(), "bbb");
  EXPECT_TRUE(browser->faults().empty());
}

TEST_F(BatchPageTest, TheHistogramCountsTheShardsAndTheWorstRunIsALink) {
  open();
  const int counted = browser->value(
      "[...document.querySelectorAll('#histogram title')].reduce((sum, t) => sum + "
      "+t.textContent.split(': ')[1], 0)");
  EXPECT_EQ(counted, 2);
  const std::string first =
      browser->value("document.querySelector('#ends a').getAttribute('href')");
  EXPECT_EQ(first, "bbb/") << "lowest first";
  EXPECT_TRUE(browser->faults().empty());
}

TEST_F(BatchPageTest, WithoutAnyFigureTheTableIsThere) {
  results.figures.clear();
  for (ShardResult& shard : results.shards) shard.figures.clear();
  open();
  EXPECT_EQ(ids(), "aaa bbb ccc");
  EXPECT_TRUE(browser->requests().empty());
  EXPECT_TRUE(browser->faults().empty());
}

}  // namespace
}  // namespace perception::test
