#include "libperception/calibration/clusters/ShapeExamples.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

using Geometry = KnownShapes::Geometry;

constexpr std::size_t kLeastSamples = 5, kLeastRecordings = 3;
constexpr double kKnownShare = 0.9;  // of the samples of a recording
constexpr double kAlike = 0.1;       // deviations: nearer to an example, a sample is none

/// Of each feature; at least a tenth.
Geometry deviations(const std::vector<Geometry>& all) {
  Geometry scale{};
  for (std::size_t i = 0; i < scale.size(); ++i) {
    double sum = 0, squares = 0;
    for (const Geometry& g : all) {
      const auto v = static_cast<double>(g[i]);
      sum += v, squares += v * v;
    }
    const auto n = static_cast<double>(all.size());
    const double variance = squares / n - sum / n * (sum / n);
    scale[i] = static_cast<float>(std::sqrt(std::max(variance, 0.01)));
  }
  return scale;
}

/// To three decimals, and no -0: what a file holds is what was judged with.
Geometry rounded(Geometry g) {
  for (float& v : g) v = static_cast<float>(std::round(static_cast<double>(v) * 1000) / 1000 + 0.0);
  return g;
}

KnownShapes::OfKind examplesOf(const std::vector<Geometry>& all) {
  KnownShapes::OfKind known;
  known.scale = rounded(deviations(all));
  for (const Geometry& g : all)
    if (std::none_of(known.examples.begin(), known.examples.end(),
                     [&](const Geometry& e) { return known.distance(g, e) < kAlike; }))
      known.examples.push_back(rounded(g));
  return known;
}

/// All samples but those of recording `without`.
std::vector<Geometry> pooled(const std::vector<std::vector<Geometry>>& of_log,
                             std::size_t without) {
  std::vector<Geometry> all;
  for (std::size_t log = 0; log < of_log.size(); ++log)
    if (log != without) all.insert(all.end(), of_log[log].begin(), of_log[log].end());
  return all;
}

}  // namespace

KnownShapes shapeExamples(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                          std::size_t without) {
  KnownShapes shapes;
  for (std::size_t kind = 0; kind < kRoadUsers; ++kind) {
    std::vector<std::vector<Geometry>> geometries(logs.size());
    for (const ClusterSample& s : samples.clusters)
      if (s.kind && static_cast<std::size_t>(*s.kind) == kind && s.log != without &&
          !logs[s.log].simulated)
        geometries[s.log].push_back(KnownShapes::geometryOf(s.descriptor));
    std::vector<double> far;  // of each recording, how far its samples are from the others
    for (std::size_t log = 0; log < geometries.size(); ++log) {
      if (geometries[log].size() < kLeastSamples) continue;
      const KnownShapes::OfKind others = examplesOf(pooled(geometries, log));
      std::vector<double> distances;
      for (const Geometry& g : geometries[log]) distances.push_back(others.distance(g));
      const auto at =
          static_cast<std::ptrdiff_t>(kKnownShare * static_cast<double>(distances.size() - 1));
      std::nth_element(distances.begin(), distances.begin() + at, distances.end());
      far.push_back(distances[static_cast<std::size_t>(at)]);
    }
    if (far.size() < kLeastRecordings) continue;
    std::sort(far.begin(), far.end());
    const double within = far[far.size() - 2];
    if (!std::isfinite(within)) continue;
    shapes.of(kind) = examplesOf(pooled(geometries, geometries.size()));
    shapes.of(kind).within = within;
  }
  return shapes;
}

}  // namespace perception
