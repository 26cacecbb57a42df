#include "libperception/calibration/detectors/DetectorFigures.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace perception {
namespace {

/// [s] Within it detections of one scene depend on each other: an object stays hidden.
constexpr double kBlock = 4;

std::vector<BlockCount> valuesOf(const std::map<std::pair<std::size_t, long>, BlockCount>& blocks) {
  std::vector<BlockCount> out;
  for (const auto& [key, block] : blocks) out.push_back(block);
  return out;
}

std::pair<std::size_t, long> blockOf(std::size_t log, double t) {
  return {log, std::lround(std::floor(t / kBlock))};
}

}  // namespace

CredibleInterval detectionOf(const DetectorCounts& counts, ClassId c, const ChancePick& pick) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || !pick(k)) continue;
    BlockCount& block = blocks[blockOf(k.log, k.t)];
    ++block.chances, block.events += k.label >= 0 ? 1 : 0;
  }
  return shareInterval(valuesOf(blocks));
}

CredibleInterval rateOf(const DetectorCounts& counts, std::size_t ClutterCount::*what) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const ClutterCount& scan : counts.clutter_scans) {
    BlockCount& block = blocks[blockOf(scan.log, scan.t)];
    ++block.chances, block.events += static_cast<double>(scan.*what);
  }
  return rateInterval(valuesOf(blocks));
}

CredibleInterval labelOf(const DetectorCounts& counts, ClassId c, int label) {
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || k.label < 0) continue;
    BlockCount& block = blocks[blockOf(k.log, k.t)];
    ++block.chances, block.events += k.label == label ? 1 : 0;
  }
  return shareInterval(valuesOf(blocks));
}

CredibleInterval noiseOf(const DetectorCounts& counts, const ClassTable& classes) {
  static const std::set<std::string> kPlaces = {"left", "right", "range", "across"};
  std::map<std::pair<std::size_t, long>, BlockCount> blocks;
  std::size_t all = 0;
  for (const DetectorError& e : counts.errors) {
    if (!classes[e.class_id].reported || kPlaces.count(e.quantity) == 0) continue;
    BlockCount& block = blocks[blockOf(e.log, e.t)];
    const double normalized = e.error / e.sigma;
    ++block.chances, block.events += normalized * normalized, ++all;
  }
  if (all < kFewestSamples) return {1, 0, 1e3};
  const CredibleInterval square = rateInterval(valuesOf(blocks));
  return {std::sqrt(square.value), std::sqrt(square.low), std::sqrt(square.high)};
}

ChanceShare shareOf(const DetectorCounts& counts, ClassId c, const ChancePick& pick) {
  ChanceShare s;
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || !pick(k)) continue;
    ++s.all, s.seen += k.label >= 0, s.stated += k.stated;
  }
  return s;
}

LabelCounts labelsOf(const DetectorCounts& counts, ClassId c, std::size_t labels) {
  LabelCounts out{std::vector<std::size_t>(labels, 0), 0};
  for (const DetectorChance& k : counts.chances) {
    if (k.class_id != c || k.label < 0) continue;
    ++out.of[static_cast<std::size_t>(k.label)], ++out.all;
  }
  return out;
}

}  // namespace perception
