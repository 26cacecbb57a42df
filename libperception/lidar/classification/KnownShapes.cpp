#include "libperception/lidar/classification/KnownShapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "libperception/lidar/classification/JsonItem.h"

namespace perception {
namespace {

constexpr double kUnknownFrom = 2;   // times `within` (assumed)
constexpr std::size_t kNearest = 3;  // examples (assumed)

/// Below them a length says nothing: the noise of ranges [m], and what it makes of a plane [-].
float leastOf(Feature f) {
  switch (f) {
    case Feature::kEdgeDistance:
    case Feature::kRoughness:
      return 0.003f;
    default:
      return 0.05f;
  }
}

KnownShapes::Geometry readGeometry(const JsonItem& item, double least) {
  constexpr double kMost = 100;
  KnownShapes::Geometry g{};
  item.size(g.size(), g.size());
  for (std::size_t i = 0; i < g.size(); ++i)
    g[i] = static_cast<float>(item.at(i).number(least, kMost));
  return g;
}

}  // namespace

KnownShapes::Geometry KnownShapes::geometryOf(const Descriptor& descriptor) {
  Geometry g{};
  for (std::size_t i = 0; i < g.size(); ++i) {
    const Feature f = kFeaturesUsed[i];
    g[i] = std::log(std::max(descriptor[static_cast<std::size_t>(f)], leastOf(f)));
  }
  return g;
}

double KnownShapes::OfKind::distance(const Geometry& a, const Geometry& b) const {
  float square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const float d = (a[i] - b[i]) / scale[i];
    square += d * d;
  }
  return std::sqrt(static_cast<double>(square) / static_cast<double>(a.size()));
}

double KnownShapes::OfKind::distance(const Geometry& geometry) const {
  std::array<double, kNearest> nearest{};  // ascending
  nearest.fill(std::numeric_limits<double>::infinity());
  for (const Geometry& example : examples) {
    double d = distance(geometry, example);
    for (double& n : nearest)
      if (d < n) std::swap(d, n);
  }
  return std::accumulate(nearest.begin(), nearest.end(), 0.0) / static_cast<double>(kNearest);
}

double KnownShapes::weight(ClusterKind kind, const Descriptor& descriptor) const {
  const OfKind& known = kinds_[static_cast<std::size_t>(kind)];
  if (known.within <= 0) return 1;
  const double over = known.distance(geometryOf(descriptor)) / known.within;
  return std::clamp((kUnknownFrom - over) / (kUnknownFrom - 1), 0.0, 1.0);
}

std::array<double, kRoadUsers> KnownShapes::weights(
    const Descriptor& descriptor, const std::array<double, kShapes>& evidence) const {
  std::array<double, kRoadUsers> weights{};
  for (std::size_t k = 0; k < kRoadUsers; ++k)
    weights[k] = evidence[k] > 0 ? weight(static_cast<ClusterKind>(k), descriptor) : 1;
  return weights;
}

KnownShapes KnownShapes::read(const JsonItem& item) {
  constexpr double kLeast = 1e-6, kFarthest = 100;
  constexpr std::size_t kMostExamples = 100000;
  item.only(
      std::vector<const char*>(kClusterKindNames.begin(), kClusterKindNames.begin() + kRoadUsers));
  KnownShapes known;
  for (std::size_t k = 0; k < kRoadUsers; ++k) {
    if (!item.has(kClusterKindNames[k])) continue;
    const JsonItem kind = item.at(kClusterKindNames[k]);
    kind.only(std::array{"within", "scale", "examples"});
    OfKind& of_kind = known.kinds_[k];
    of_kind.within = kind.at("within").number(kLeast, kFarthest);
    of_kind.scale = readGeometry(kind.at("scale"), kLeast);
    const JsonItem examples = kind.at("examples");
    const std::size_t count = examples.size(1, kMostExamples);
    for (std::size_t i = 0; i < count; ++i)
      of_kind.examples.push_back(readGeometry(examples.at(i), -kFarthest));
  }
  return known;
}

std::string KnownShapes::text() const {
  std::string out;
  for (std::size_t k = 0; k < kRoadUsers; ++k) {
    const OfKind& kind = kinds_[k];
    if (kind.within <= 0) continue;
    out +=
        fmt::format("{}{}:{{\"within\":{},\"scale\":[{}],\"examples\":[", out.empty() ? "{" : ",\n",
                    quoted(kClusterKindNames[k]), kind.within, fmt::join(kind.scale, ","));
    for (const Geometry& g : kind.examples)
      out += fmt::format("{}[{}]", out.back() == '[' ? "" : ",\n", fmt::join(g, ","));
    out += "]}";
  }
  return out.empty() ? out : out + "}";
}

}  // namespace perception
