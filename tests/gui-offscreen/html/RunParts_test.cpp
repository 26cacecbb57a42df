#include "gui-offscreen/html/RunParts.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "gui-offscreen/html/ReportPage.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

constexpr std::size_t kPart = RunParts::kScenes;

/// `count` scenes at 10 Hz; a car in all of them, a second one in the last alone.
TrackedRun runOfParts(std::size_t count) {
  TrackedRun run;
  run.first_stamp = Stamp::fromSeconds(1000);
  run.class_names = {"car", "static-other"};
  for (std::size_t k = 0; k < count; ++k) {
    Scene scene;
    scene.stamp = run.first_stamp + 0.1 * static_cast<double>(k);
    SceneObject car;
    car.id = 7;
    car.class_probability = {0.9, 0.1};
    scene.objects = {car};
    if (k + 1 == count) {
      car.id = 8;
      scene.objects.push_back(car);
    }
    run.scenes.push_back(scene);
  }
  return run;
}

RunOutline outlineOf(const TrackedRun& run) {
  RunOutline outline{run.dir, run.first_stamp, run.class_names, {}};
  for (const Scene& scene : run.scenes) outline.stamps.push_back(scene.stamp);
  return outline;
}

using Views = std::map<std::size_t, SceneView>;

/// All scenes of the run with some views, and errors by scene.
std::unique_ptr<RunParts> partsOf(const TrackedRun& run, const Views& views = {},
                                  const RunData::Budget& budget = {}, const RunErrors& errors = {},
                                  const RunRecord& record = {}) {
  static const test::TemporaryFolder folder;
  auto parts =
      std::make_unique<RunParts>(outlineOf(run), record, folder / "page.html",
                                 RunParts::Options{"run", !errors.empty(), std::nullopt, budget});
  for (std::size_t from = 0; from < run.scenes.size(); from += kPart) {
    const std::size_t to = std::min(from + kPart, run.scenes.size());
    const auto at = [&](const auto& all, std::size_t k) {
      return all.begin() + static_cast<std::ptrdiff_t>(k);
    };
    parts->begin({at(run.scenes, from), at(run.scenes, to)},
                 errors.empty() ? errors : RunErrors(at(errors, from), at(errors, to)));
    for (std::size_t k = from; k < to; ++k) {
      if (const auto view = views.find(k); view != views.end()) parts->add(k, view->second);
    }
  }
  return parts;
}

std::string htmlOf(RunParts& parts) {
  std::string html;
  parts.write([&](std::string_view piece) { html += piece; });
  return html;
}

SceneView returns(int count) {
  SceneView view;
  for (int i = 0; i < count; ++i) view.points.push_back({Vector3(0.001 * i, 2, 1), 1, 1});
  return view;
}

/// The text of an element, unpacked; empty: there is none.
std::string contentOf(const std::string& html, const std::string& id) {
  const std::string head = "id=\"" + id + "\">";
  const std::size_t from = html.find(head);
  if (from == std::string::npos) return "";
  std::string bytes;
  std::uint32_t bits = 0;
  int have = 0;
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = from + head.size(); html[i] != '<' && html[i] != '='; ++i) {
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(html[i]));
    if ((have += 6) < 8) continue;
    have -= 8;
    bytes += static_cast<char>(bits >> have & 255);
  }
  std::string text(1 << 24, ' ');
  z_stream z{};
  if (inflateInit2(&z, 15 + 16) != Z_OK) return "";
  z.next_in = reinterpret_cast<Bytef*>(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(text.data());
  z.avail_out = static_cast<uInt>(text.size());
  inflate(&z, Z_FINISH);
  text.resize(z.total_out);
  inflateEnd(&z);
  return text;
}

nlohmann::json partOf(const std::string& html, std::size_t n) {
  const std::string bytes = contentOf(html, "run-" + std::to_string(n));
  std::size_t length = 0;
  for (std::size_t i = 4; i-- > 0;) length = length << 8 | static_cast<std::uint8_t>(bytes.at(i));
  return nlohmann::json::parse(bytes.substr(4, length));
}

TEST(RunParts, TheIndexSaysInWhichPartsAnObjectIs) {
  const TrackedRun run = runOfParts(2 * kPart + 1);
  const std::string html = htmlOf(*partsOf(run, {{0, returns(3)}}));
  const auto index = nlohmann::json::parse(contentOf(html, "run-data"));
  EXPECT_EQ(index["parts"], nlohmann::json({0, kPart, 2 * kPart}));
  EXPECT_EQ(index["objects"].dump(), "[[7,0,2],[8,2,2]]");
  EXPECT_EQ(index["layers"], nlohmann::json({"points"}));
  EXPECT_EQ(index["times"].size(), run.scenes.size());
  EXPECT_DOUBLE_EQ(index["times"].back().get<double>(), 0.1 * 2 * kPart);
  EXPECT_EQ(index["points"]["kept"], 3);
}

TEST(RunParts, PartsHoldTheirScenesAlone) {
  const TrackedRun run = runOfParts(kPart + 2);
  const std::string html = htmlOf(*partsOf(run, {{kPart + 1, returns(2)}}));
  const auto part = partOf(html, 1);
  EXPECT_EQ(part["scenes"].size(), 2u);
  EXPECT_EQ(part["scenes"][1]["block"], nlohmann::json({0, 2, 0}));
  EXPECT_EQ(part["objects"][0]["k"], nlohmann::json({0, 1}));
  EXPECT_EQ(partOf(html, 0)["scenes"].size(), kPart);
  EXPECT_EQ(contentOf(html, "run-2"), "");
}

TEST(RunParts, WhereTheBudgetIsSmallEveryNthSceneHasSensorData) {
  const TrackedRun run = runOfParts(kPart);
  RunData::Budget budget;
  budget.points = 120'000;
  Views views;
  for (std::size_t k = 0; k < kPart; ++k) views[k] = returns(2000);
  const auto parts = partsOf(run, views, budget);
  std::size_t sensed = 0;
  const std::string html = htmlOf(*parts);
  const auto part = partOf(html, 0);
  for (std::size_t k = 0; k < kPart; ++k) {
    const auto& scene = part["scenes"][k];
    EXPECT_EQ(scene.contains("block"), parts->sensed(k)) << k;
    if (!scene.contains("block")) continue;
    ++sensed;
    EXPECT_GE(scene["block"][1].get<std::size_t>(), RunParts::kLeastReturns);
  }
  EXPECT_TRUE(parts->sensed(0));
  EXPECT_GT(sensed, 5u);
  EXPECT_LT(sensed, kPart);
  EXPECT_LT(html.size(), budget.points) << "returns and tracks: they pack well";
}

TEST(RunParts, ErrorsStayWithTheirScene) {
  const TrackedRun run = runOfParts(kPart + 2);
  RunErrors errors(run.scenes.size());
  errors[kPart + 1][7].position = 0.5;
  const std::string html = htmlOf(*partsOf(run, {}, {}, errors));
  EXPECT_EQ(partOf(html, 1)["objects"][0]["err"].dump(), "[null,[-1,0.5,null,null,0]]");
  EXPECT_EQ(nlohmann::json::parse(contentOf(html, "run-data"))["judged"], true);
}

TEST(RunParts, NamesCannotEndTheScript) {
  const TrackedRun run = runOfParts(2);
  RunRecord record;
  record.input = "</script><b>.rawlog";
  nlohmann::json event = {{"t", 0}, {"message", "</script>"}};
  ReportContent content;
  content.run = outlineOf(run);
  content.record = record;
  content.parts = partsOf(run, {}, {}, {}, record);
  content.parts->addEvent(event);
  std::string page;
  writeHtmlPage(content, [&](std::string_view piece) { page += piece; });
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  std::size_t open = 0, closed = 0;
  for (std::size_t i = 0; (i = page.find("<script", i)) != std::string::npos; ++i) ++open;
  for (std::size_t i = 0; (i = page.find("</script", i)) != std::string::npos; ++i) ++closed;
  EXPECT_EQ(open, 4u) << "index, part, events and program";
  EXPECT_EQ(closed, open);
}

TEST(RunParts, EventsAreInElementsOfTheirOwn) {
  const TrackedRun run = runOfParts(2);
  const auto parts = partsOf(run);
  for (std::size_t i = 0; i < RunParts::kEvents + 1; ++i) parts->addEvent({{"t", i}});
  const std::string html = htmlOf(*parts);
  const auto first = nlohmann::json::parse(contentOf(html, "run-events-0"));
  const auto second = nlohmann::json::parse(contentOf(html, "run-events-1"));
  EXPECT_EQ(first.size(), RunParts::kEvents);
  EXPECT_EQ(second.dump(), nlohmann::json::array({{{"t", RunParts::kEvents}}}).dump());
  EXPECT_EQ(nlohmann::json::parse(contentOf(html, "run-data"))["eventCount"],
            RunParts::kEvents + 1);
}

TEST(RunParts, AreTheSameForTheSameRun) {
  const TrackedRun run = runOfParts(kPart + 1);
  const auto page = [&] { return htmlOf(*partsOf(run, {{0, returns(100)}})); };
  EXPECT_EQ(page(), page());
}

}  // namespace
}  // namespace perception
