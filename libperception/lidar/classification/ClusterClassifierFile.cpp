// Reading and writing of ClusterClassifier.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/lidar/classification/ClusterClassifier.h"
#include "libperception/lidar/classification/JsonItem.h"
#include "libperception/lidar/classification/TreesText.h"

namespace perception {
namespace {

using Json = nlohmann::json;
using Keys = std::vector<const char*>;

constexpr const char* kFormat = "perception lidar classifier";
constexpr int kVersion = 1;
constexpr std::size_t kMostBytes = 64UL << 20, kMostValues = 2000000, kMostNodes = 100000,
                      kMostKnots = 10000, kMostWords = 1000;
constexpr int kMostDepth = 8;          // of arrays and objects in each other; 5 are needed
constexpr double kLeastPrior = 1e-12;  // keeps its log finite

std::string contents(const std::string& file) {
  if (const auto what = irregularity(file); !what.empty())
    throw DataError(fmt::format("{}: is {}, expected a file", file, what));
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw DataError(fmt::format("{}: no such file, or it cannot be read", file),
                    ExitCode::kNoInput);
  std::string text;
  std::vector<char> part(1 << 16);
  while (in.read(part.data(), static_cast<std::streamsize>(part.size())), in.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMostBytes)
      throw DataError(fmt::format("{}: more than {} bytes", file, kMostBytes));
  }
  if (in.bad()) throw DataError(fmt::format("{}: cannot be read", file));
  return text;
}

/// Parses within the limits of depth and number of values.
Json parsed(const std::string& text, const std::string& name) {
  std::size_t values = 0;
  const auto limit = [&](int depth, Json::parse_event_t, const Json&) {
    if (depth > kMostDepth)
      throw DataError(
          fmt::format("{}: more than {} arrays and objects in each other, expected a {}", name,
                      kMostDepth, kFormat));
    if (++values > kMostValues)
      throw DataError(fmt::format("{}: more than {} values", name, kMostValues));
    return true;
  };
  try {
    return Json::parse(text, limit);
  } catch (const Json::exception& e) {
    throw DataError(fmt::format("{}: not a {}: {}", name, kFormat, e.what()));
  }
}

template <class Names>
void readNames(const JsonItem& item, const Names& names) {
  item.size(names.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) item.at(i).mustBe(names[i]);
}

Provenance readProvenance(const JsonItem& item) {
  item.only(Keys{"version", "date", "license", "data", "simulated_only"});
  Provenance p;
  p.version = item.at("version").text();
  p.date = item.at("date").text();
  p.license = item.at("license").text();
  const JsonItem data = item.at("data");
  const std::size_t names = data.size(0, kMostWords);
  for (std::size_t i = 0; i < names; ++i) p.data.push_back(data.at(i).text());
  p.simulated_only = item.at("simulated_only").flag();
  return p;
}

EvidenceMemory readMemory(const JsonItem& item) {
  constexpr double kLeast = 1e-6, kMost = 1e6;
  item.only(Keys{"lasting", "kept", "bearing", "log_range", "time", "renewal"});
  EvidenceMemory p;
  p.lasting = item.at("lasting").number(0, 0.999);
  p.kept = item.at("kept").number(0, 0.999);
  p.bearing = item.at("bearing").number(kLeast, kMost);
  p.log_range = item.at("log_range").number(kLeast, kMost);
  p.time = item.at("time").number(kLeast, kMost);
  p.renewal = item.at("renewal").number(kLeast, kMost);
  return p;
}

std::array<double, kClusterKinds> readPrior(const JsonItem& item) {
  std::array<double, kClusterKinds> prior{};
  item.size(kClusterKinds, kClusterKinds);
  double sum = 0;
  for (std::size_t k = 0; k < kClusterKinds; ++k)
    sum += prior[k] = item.at(k).number(kLeastPrior, 1);
  if (std::abs(sum - 1) > 1e-6) item.fail(fmt::format("a sum of 1, not {:.9g}", sum));
  return prior;
}

Calibration readCalibration(const JsonItem& item) {
  Calibration c;
  const std::size_t knots = item.size(0, kMostKnots);
  for (std::size_t i = 0; i < knots; ++i) {
    const JsonItem pair = item.at(i);
    pair.size(2, 2);
    const JsonItem raw = pair.at(0, "raw"), calibrated = pair.at(1, "calibrated");
    const Knot knot{raw.number(0, 1), calibrated.number(0, 1)};
    if (i > 0 && !(knot.raw > c.knots.back().raw)) raw.fail("more than that of the knot before");
    if (i > 0 && knot.calibrated < c.knots.back().calibrated)
      calibrated.fail("no less than that of the knot before");
    c.knots.push_back(knot);
  }
  return c;
}

/// Node `self` of the `count` of a tree.
BoostedTrees::Node readNode(const JsonItem& item, std::int32_t root, std::size_t self,
                            std::size_t count) {
  BoostedTrees::Node node;
  const std::size_t fields = item.size(1, 4);
  if (fields == 1) {
    node.threshold = item.at(0, "value").real();
    return node;
  }
  if (fields != 4) item.fail("[value] or [feature, threshold, left, right]");
  if (self + 1 == count) item.fail("[value], as no node follows");
  const auto child = [&](std::size_t at, const char* name) {
    return root + static_cast<std::int32_t>(item.at(at, name).whole(
                      static_cast<std::int64_t>(self) + 1, static_cast<std::int64_t>(count) - 1));
  };
  node.feature = static_cast<std::int16_t>(
      item.at(0, "feature").whole(0, static_cast<std::int64_t>(kFeatures) - 1));
  node.threshold = item.at(1, "threshold").real();
  node.left = child(2, "left");
  node.right = child(3, "right");
  return node;
}

void readTree(const JsonItem& tree, BoostedTrees& trees) {
  tree.only(Keys{"node"});
  const JsonItem list = tree.at("node");
  const auto root = static_cast<std::int32_t>(trees.nodes.size());
  const std::size_t count = list.size(1, kMostNodes);
  if (trees.nodes.size() + count > kMostNodes)
    list.fail(fmt::format("at most {} nodes in all trees", kMostNodes));
  trees.roots.push_back(root);
  for (std::size_t i = 0; i < count; ++i)
    trees.nodes.push_back(readNode(list.at(i), root, i, count));
}

void readBase(const JsonItem& base, BoostedTrees& trees) {
  constexpr double kMost = 1000;  // |score|
  base.size(kClusterKinds, kClusterKinds);
  for (std::size_t k = 0; k < kClusterKinds; ++k) trees.base[k] = base.at(k).number(-kMost, kMost);
}

void readTrees(const JsonItem& list, BoostedTrees& trees) {
  const std::size_t count = list.size(kClusterKinds, kMostNodes);
  if (count % kClusterKinds != 0) list.fail(fmt::format("a multiple of {} trees", kClusterKinds));
  for (std::size_t i = 0; i < count; ++i) readTree(list.at(i), trees);
}

/// The shortest text that reads back as the same double and the same float.
std::string numberText(double v) { return v == 0 ? "0" : fmt::format("{}", v); }
std::string numberText(float v) {
  if (v == 0) return "0";
  const std::string text = fmt::format("{}", v);
  // Through a double, few floats are not read back from the shortest text, such as 7.038531e-26.
  double read = 0;
  std::from_chars(text.data(), text.data() + text.size(), read);
  return static_cast<float>(read) == v ? text : fmt::format("{:.9g}", static_cast<double>(v));
}

template <class List, class Text>
std::string arrayText(const List& list, const Text& text) {
  std::string out = "[";
  for (const auto& entry : list) out += (out.size() > 1 ? "," : "") + text(entry);
  return out + "]";
}
template <class List>
std::string numbersText(const List& list) {
  return arrayText(list, [](double v) { return numberText(v); });
}

std::string treeText(const BoostedTrees& trees, std::size_t tree) {
  const auto begin = static_cast<std::size_t>(trees.roots[tree]);
  const std::size_t end = tree + 1 < trees.roots.size()
                              ? static_cast<std::size_t>(trees.roots[tree + 1])
                              : trees.nodes.size();
  const std::int32_t root = trees.roots[tree];
  std::string out;
  for (std::size_t i = begin; i < end; ++i) {
    const BoostedTrees::Node& n = trees.nodes[i];
    out += i > begin ? "," : "";
    out += n.feature < 0 ? fmt::format("[{}]", numberText(n.threshold))
                         : fmt::format("[{},{},{},{}]", n.feature, numberText(n.threshold),
                                       n.left - root, n.right - root);
  }
  return "{\"node\":[" + out + "]}";
}

}  // namespace

ClusterClassifier ClusterClassifier::read(const std::string& file) {
  return parse(contents(file), file);
}

ClusterClassifier ClusterClassifier::parse(const std::string& text, const std::string& name) {
  auto separate = separateTrees(text, kMostNodes);
  const Json json = parsed(separate ? separate->text : text, name);
  const JsonItem top(json, name);
  top.at("format").mustBe(kFormat);
  top.at("version").mustBe(kVersion);
  top.only(Keys{"format", "version", "provenance", "features", "kinds", "memory", "prior",
                "calibration", "known", "base", "trees"});
  readNames(top.at("features"), featureNames());
  readNames(top.at("kinds"), kClusterKindNames);
  Provenance provenance = readProvenance(top.at("provenance"));
  const EvidenceMemory memory = readMemory(top.at("memory"));
  const auto prior = readPrior(top.at("prior"));
  std::array<Calibration, kClusterKinds> calibrations;
  const JsonItem maps = top.at("calibration");
  maps.only(kClusterKindNames);
  for (std::size_t k = 0; k < kClusterKinds; ++k)
    calibrations[k] = readCalibration(maps.at(kClusterKindNames[k]));
  const KnownShapes known = top.has("known") ? KnownShapes::read(top.at("known")) : KnownShapes{};
  BoostedTrees trees;
  if (separate) trees = std::move(separate->trees);
  readBase(top.at("base"), trees);
  if (!separate) readTrees(top.at("trees"), trees);
  return ClusterClassifier(std::move(trees), std::move(calibrations), prior, memory,
                           std::move(provenance), known);
}

std::string ClusterClassifier::write() const {
  const auto quotedName = [](const std::string& name) { return quoted(name); };
  std::string out = fmt::format("{{\"format\":{},\"version\":{},\n", quoted(kFormat), kVersion);
  out += fmt::format(
      "\"provenance\":{{\"version\":{},\"date\":{},\"license\":{},\"data\":{},"
      "\"simulated_only\":{}}},\n",
      quoted(provenance_.version), quoted(provenance_.date), quoted(provenance_.license),
      arrayText(provenance_.data, quotedName), provenance_.simulated_only);
  out += fmt::format("\"features\":{},\n\"kinds\":{},\n", arrayText(featureNames(), quotedName),
                     arrayText(kClusterKindNames, quotedName));
  out += fmt::format(
      "\"memory\":{{\"lasting\":{},\"kept\":{},\"bearing\":{},\"log_range\":{},\"time\":{},"
      "\"renewal\":{}}},\n\"prior\":{},\n",
      numberText(memory_.lasting), numberText(memory_.kept), numberText(memory_.bearing),
      numberText(memory_.log_range), numberText(memory_.time), numberText(memory_.renewal),
      numbersText(prior_));
  out += "\"calibration\":{\n";
  for (std::size_t k = 0; k < kClusterKinds; ++k)
    out += fmt::format("{}:{}{}\n", quoted(kClusterKindNames[k]),
                       arrayText(calibrations_[k].knots,
                                 [](const Knot& knot) {
                                   return numbersText(std::array{knot.raw, knot.calibrated});
                                 }),
                       k + 1 < kClusterKinds ? "," : "},");
  if (const std::string known = known_.text(); !known.empty()) out += "\"known\":" + known + ",\n";
  out += fmt::format("\"base\":{},\n\"trees\":[\n", numbersText(trees_.base));
  for (std::size_t t = 0; t < trees_.roots.size(); ++t)
    out += treeText(trees_, t) + (t + 1 < trees_.roots.size() ? ",\n" : "\n");
  return out + "]}\n";
}

}  // namespace perception
