#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "tests/architecture/Modules.h"
#include "tests/architecture/SourceTree.h"

// docs/structure.svg is drawn here, from the table of modules. After a change of that table:
//   PERCEPTION_WRITE_STRUCTURE=1 build/bin/architecture_tests --gtest_filter='Structure.*'
namespace perception::test {
namespace {

using Lines = std::vector<std::string>;

/// 0 for a module without others below, else one more than the highest of them.
int layerOf(const Module& module) {
  int layer = 0;
  for (const std::string& other : module.may_include)
    layer = std::max(layer, layerOf(*moduleNamed(other)) + 1);
  return layer;
}

std::string joinedBy(const Lines& words, const std::string& between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

Lines wrapped(const std::string& text, std::size_t width) {
  Lines lines;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    if (lines.empty() || lines.back().size() + 1 + word.size() > width)
      lines.push_back(word);
    else
      lines.back() += " " + word;
  }
  return lines;
}

constexpr int kLeft = 150, kChainWidth = 200, kBoxWidth = 138, kBoxHeight = 106, kGap = 8,
              kLayer = 128, kTop = 74, kWidth = 1400;

std::string attribute(const char* name, int value) {
  return std::string(" ") + name + "=\"" + std::to_string(value) + "\"";
}

std::string text(int x, int y, const std::string& style, const std::string& words) {
  return "<text" + attribute("x", x) + attribute("y", y) + " class=\"" + style + "\">" + words +
         "</text>\n";
}

std::string box(int x, int y, int width, int height, const std::string& style) {
  return "<rect" + attribute("x", x) + attribute("y", y) + attribute("width", width) +
         attribute("height", height) + " rx=\"5\" class=\"" + style + "\"/>\n";
}

std::string arrow(int x1, int y1, int x2, int y2) {
  return "<line" + attribute("x1", x1) + attribute("y1", y1) + attribute("x2", x2) +
         attribute("y2", y2) + " class=\"chain\" marker-end=\"url(#head)\"/>\n";
}

std::string boxOf(const Module& module, int x, int y) {
  const int width = module.chain ? kChainWidth : kBoxWidth;
  std::string svg = box(x, y, width, kBoxHeight, module.chain ? "on" : "beside");
  svg += text(x + 8, y + 19, "name", module.name);
  int line = y + 36;
  const std::size_t letters = static_cast<std::size_t>(width) * 10 / 65;
  for (const std::string& part : wrapped(module.what, letters)) {
    svg += text(x + 8, line, "what", part);
    line += 13;
  }
  const std::string below = joinedBy(nearestBelow(module), ", ");
  const Lines uses = wrapped(below.empty() ? "" : "on " + below, letters + 2);
  line = y + kBoxHeight - 7 - 12 * (static_cast<int>(uses.size()) - 1);
  for (const std::string& part : uses) {
    svg += text(x + 8, line, "uses", part);
    line += 12;
  }
  if (module.stage > 0) {
    svg += "<circle" + attribute("cx", x + width - 13) + attribute("cy", y + 14) +
           " r=\"9\" class=\"stage\"/>\n";
    svg += text(x + width - 13, y + 18, "number", std::to_string(module.stage));
  }
  return svg;
}

const char* const kStyle = R"(<style>
text { font-family: sans-serif; fill: #222 }
.title { font-size: 20px; font-weight: bold } .layer { font-size: 12px; fill: #555 }
.name { font-size: 15px; font-weight: bold } .what { font-size: 11px } .uses { font-size: 10px; fill: #777; font-style: italic }
.on { fill: #ffe3b8; stroke: #c46a00; stroke-width: 2 } .beside { fill: #eef3f9; stroke: #7a92ad }
.band { fill: #fafafa; stroke: #ddd } .chain { stroke: #c46a00; stroke-width: 4 }
.stage { fill: #c46a00 } .number { font-size: 11px; fill: #fff; font-weight: bold; text-anchor: middle }
</style>
<defs><marker id="head" markerWidth="4" markerHeight="4" refX="2" refY="2" orient="auto"><path d="M0,0 L4,2 L0,4 z" fill="#c46a00"/></marker></defs>
)";

const char* layerTitle(int layer) {
  static const std::vector<const char*> titles = {
      "Base",         "Tools",   "Measurements", "One sensor,|one scan,|one filter",
      "Scenes, logs", "One run", "Many runs",    "Whole tasks",
      "Programs",     "Mains"};
  return layer < static_cast<int>(titles.size()) ? titles[static_cast<std::size_t>(layer)] : "";
}

std::string filterInside(int y) {
  static const Lines layers = {"simd",      "state",  "predict",           "likelihood",
                               "associate", "update", "Step, CRbpfTracker"};
  std::string svg = text(12, y + 22, "layer", "Inside filter");
  int x = kLeft;
  for (const std::string& name : layers) {
    if (x > kLeft) svg += arrow(x - 22, y + 18, x - 8, y + 18);
    const int width = 28 + 9 * static_cast<int>(name.size());
    svg += box(x, y, width, 36, "on") + text(x + 12, y + 23, "name", name);
    x += width + 28;
  }
  return svg;
}

std::string drawn() {
  std::map<int, std::vector<const Module*>> layers;
  for (const Module& module : modules()) layers[layerOf(module)].push_back(&module);
  const int top = layers.rbegin()->first;
  const auto layerY = [&](int layer) { return kTop + (top - layer) * kLayer; };
  std::string bands, boxes, chain;
  int last = -1;
  for (const auto& [layer, members] : layers) {
    const int y = layerY(layer);
    bands += box(4, y - 8, kWidth - 8, kLayer - 10, "band");
    std::istringstream title(layerTitle(layer));
    int line = y + 22;
    for (std::string part; std::getline(title, part, '|'); line += 16)
      bands += text(12, line, "layer", part);
    int x = kLeft + kChainWidth + 2 * kGap;
    for (const Module* module : members) {
      if (module->chain) {
        boxes += boxOf(*module, kLeft, y);
        if (last >= 0)
          chain += arrow(kLeft + kChainWidth / 2, layerY(last), kLeft + kChainWidth / 2,
                         y + kBoxHeight + 8);
        last = layer;
      } else {
        boxes += boxOf(*module, x, y);
        x += kBoxWidth + kGap;
      }
    }
  }
  const int inside = layerY(0) + kLayer + 4, height = inside + 50;
  return "<svg xmlns=\"http://www.w3.org/2000/svg\"" + attribute("width", kWidth) +
         attribute("height", height) + ">\n" + kStyle +
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         text(12, 28, "title",
              "Modules: each includes some of those below it (the nearest are named in italics)") +
         text(12, 50, "layer",
              "Orange: the main dependency chain. Numbers: the order of processing from log to "
              "scene. Drawn "
              "and checked "
              "by tests/architecture.") +
         bands + chain + boxes + filterInside(inside) + "</svg>\n";
}

TEST(Structure, ThePictureIsThatOfTheTable) {
  const auto path = std::filesystem::path(PERCEPTION_SOURCE_DIR) / "docs" / "structure.svg";
  const std::string svg = drawn();
  if (std::getenv("PERCEPTION_WRITE_STRUCTURE") != nullptr)
    std::ofstream(path, std::ios::binary) << svg;
  EXPECT_TRUE(readWhole(path) == svg) << "see the first lines of this file";
}

TEST(Structure, LayersFollowFromTheTable) {
  EXPECT_EQ(layerOf(*moduleNamed("core")), 0);
  EXPECT_GT(layerOf(*moduleNamed("filter")), layerOf(*moduleNamed("measurement")));
  EXPECT_EQ(nearestBelow(*moduleNamed("scene")), Lines{"filter"});
}

TEST(Structure, AllFoldersAreInThePicture) {
  const auto root = std::filesystem::path(PERCEPTION_SOURCE_DIR) / "libperception";
  for (const auto& entry : std::filesystem::directory_iterator(root)) {
    if (!entry.is_directory()) continue;
    EXPECT_NE(moduleNamed(entry.path().filename().string()), nullptr) << entry.path();
  }
}

}  // namespace
}  // namespace perception::test
