#include "studies/weather/SnowRealismStudy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <variant>

#include "libperception/calibration/clusters/PointLabels.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Median.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "libperception/simulation/weather/particles/Precipitation.h"

namespace perception {
namespace {

constexpr std::uint32_t kPlainPurpose = 0x5f0e58, kDrawPurpose = 0x5f0e59;
constexpr double kReflectivity = 0.9, kDivergence = 0.003;  // method.md 9.2

using Rows = std::vector<SnowFeatures>;

constexpr std::size_t kIntensity = 1, kHeight = 9;  // features

/// Rows of snow in the scans of the even (0) or odd (1) blocks.
struct Halves {
  Rows of[2];
  double per_scan = 0, share = 0;  ///< snow returns a scan, of all returns in the sector
};

/// `mounted`: heights above the sensor, as if all were mounted alike.
Halves halvesOf(const std::vector<SnowScan>& scans, const SnowRealismParams& params,
                bool mounted = false) {
  Halves halves;
  std::size_t returns = 0, snow = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    Rows rows = snowFeatures(scans[s], params.sector);
    if (mounted)
      for (auto& row : rows) row[kHeight] -= static_cast<float>(scans[s].height);
    Rows& half = halves.of[s / params.block % 2];
    half.insert(half.end(), rows.begin(), rows.end());
    returns += scans[s].places.size(), snow += rows.size();
  }
  halves.per_scan = static_cast<double>(snow) / static_cast<double>(scans.size());
  halves.share = static_cast<double>(snow) / static_cast<double>(returns);
  return halves;
}

void shuffle(Rows& rows, Rng& rng) {
  for (std::size_t i = rows.size(); i > 1; --i)
    std::swap(rows[i - 1], rows[rng.below(static_cast<std::uint32_t>(i))]);
}

/// As many of both; with `bin` [m] > 0, as many of both at every range.
std::vector<SnowRow> balanced(Rows real, Rows simulated, std::size_t most, double bin, Rng rng) {
  shuffle(real, rng), shuffle(simulated, rng);
  const auto binOf = [&](const SnowFeatures& f) {
    return bin > 0 ? static_cast<int>(static_cast<double>(f[0]) / bin) : 0;
  };
  std::map<int, std::size_t> of_real, of_simulated;
  for (const auto& f : real) ++of_real[binOf(f)];
  for (const auto& f : simulated) ++of_simulated[binOf(f)];
  std::vector<SnowRow> rows;
  const auto take = [&](const Rows& from, bool is_real) {
    std::map<int, std::size_t> taken;
    std::vector<SnowRow> kept;
    for (const auto& f : from) {
      const int b = binOf(f);
      if (taken[b]++ < std::min(of_real[b], of_simulated[b])) kept.push_back({f, is_real});
    }
    if (kept.size() > most) kept.resize(most);
    rows.insert(rows.end(), kept.begin(), kept.end());
  };
  take(real, true), take(simulated, false);
  return rows;
}

/// What the forest sees.
struct View {
  double range_bin = 0;               ///< [m] > 0: as many of both at every range
  std::vector<std::size_t> hidden{};  ///< features
  bool importance = false;            ///< wanted
};

/// Forests of both halves, each judged on the other.
struct Judgment {
  double area = 0;  ///< NaN: nothing in common to judge
  std::vector<double> falls = std::vector<double>(kSnowFeatures), alone = falls;
  std::size_t rows = 0;  ///< of a kind, judged
};

std::string areaText(const Judgment& j) {
  return std::isnan(j.area) ? "-" : fmt::format("{:.3f}", j.area);
}

void blind(std::vector<SnowRow>& rows, const std::vector<std::size_t>& features) {
  for (SnowRow& row : rows)
    for (const std::size_t f : features) row.features[f] = 0;
}

Judgment judge(const Halves& real, const Halves& simulated, const View& view,
               const SnowRealismParams& params) {
  Judgment j;
  for (std::size_t fold = 0; fold < 2; ++fold) {
    const auto draw = [&](std::size_t half) {
      auto rows = balanced(real.of[half], simulated.of[half], params.most, view.range_bin,
                           Rng({params.seed, half, 0, kDrawPurpose}));
      blind(rows, view.hidden);
      return rows;
    };
    const auto train = draw(fold), test = draw(1 - fold);
    if (train.empty() || test.empty()) {  // no range in common
      j.area = std::numeric_limits<double>::quiet_NaN();
      return j;
    }
    const SnowForest forest(train, params.seed);
    j.area += .5 * forest.area(test);
    j.rows += test.size() / 2;
    if (!view.importance) continue;
    const auto falls = forest.importance(test, params.seed);
    std::vector<double> values(test.size());
    for (std::size_t f = 0; f < kSnowFeatures; ++f) {
      j.falls[f] += .5 * falls[f];
      std::transform(test.begin(), test.end(), values.begin(),
                     [&](const SnowRow& r) { return static_cast<double>(r.features[f]); });
      j.alone[f] += .5 * areaUnderCurve(values, test);
    }
  }
  return j;
}

std::vector<std::size_t> strongestFirst(const Judgment& j) {
  std::vector<std::size_t> order(kSnowFeatures);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return j.falls[a] > j.falls[b]; });
  return order;
}

double middleOf(const Halves& halves, std::size_t feature) {
  std::vector<float> values;
  for (const Rows& half : halves.of)
    for (const auto& f : half) values.push_back(f[feature]);
  return values.empty() ? 0 : static_cast<double>(medianOf(std::move(values)));
}

StudyTable featuresTable(const std::string& name, const Halves& real, const Halves& simulated,
                         const Judgment& j, std::size_t number) {
  StudyTable table;
  table.name = fmt::format("features_{}", number);
  table.title = fmt::format("{}: features, those that betray most first", name);
  table.columns = {"feature", "AUC lost by permuting it", "AUC of it alone", "median, recorded",
                   "median, simulated"};
  for (const std::size_t f : strongestFirst(j))
    table.rows.push_back(
        {kSnowFeatureNames[f], fmt::format("{:.3f}", j.falls[f]), fmt::format("{:.3f}", j.alone[f]),
         fmt::format("{:.3f}", middleOf(real, f)), fmt::format("{:.3f}", middleOf(simulated, f))});
  return table;
}

}  // namespace

std::vector<SnowScan> readSnowScans(const std::string& rawlog, const SnowSector& sector) {
  registerPerceptionClasses();
  const PointLabels labels(rawlog);
  std::vector<SnowScan> scans;
  RawlogReader reader(rawlog);
  std::int64_t number = -1;
  while (const auto observation = reader.next()) {
    if (const auto n = frameNumber(*observation)) number = *n;
    const auto frame = frameFromObservation(*observation);
    if (!frame) continue;
    const auto* cloud = std::get_if<LidarCloud>(&frame->data);
    if (!cloud) continue;
    const auto classes = labels.ofFrame(number, cloud->size());
    if (classes)
      scans.push_back(
          comparableScan(*cloud, *classes, frame->T_ego_sensor.translation().z(), sector));
  }
  if (scans.empty()) throw DataError(rawlog + ": no lidar scan with labels of its points");
  return scans;
}

SnowScan plainSnow(const SnowScan& scan, double mm_h, const RngKey& key) {
  const auto flakes = std::count(scan.snow.begin(), scan.snow.end(), true);
  const double chance =
      static_cast<double>(flakes) / static_cast<double>(std::max<std::size_t>(1, scan.snow.size()));
  const double diameter = 1e-3 / gunnMarshall(mm_h).slope;
  SnowScan plain;
  plain.height = scan.height;
  for (std::size_t i = 0; i < scan.places.size(); ++i) {
    Rng rng(key.withSlot(static_cast<std::uint32_t>(i)).withPurpose(kPlainPurpose));
    const bool flake = rng.uniform() < chance;
    if (!flake && scan.snow[i]) continue;  // of what is behind it nothing is known
    plain.places.push_back(scan.places[i]);
    plain.intensity.push_back(scan.intensity[i]);
    plain.snow.push_back(flake);
    if (!flake) continue;
    const double range = kSnowReturns.range(rng);
    const double filled = rng.exponential(diameter) / (range * kDivergence);
    plain.places.back() *= range / scan.places[i].norm();
    plain.intensity.back() = kReflectivity * std::min(1.0, filled * filled);
  }
  return plain;
}

StudyReport snowRealismStudy(const SnowRealismParams& params, const SnowLog& real,
                             const std::vector<SnowLog>& simulated) {
  const Halves recorded = halvesOf(real.scans, params),
               recorded_alike = halvesOf(real.scans, params, true);
  StudyReport report;
  report.title = "Simulated and recorded snow";
  report.data = "recorded snow of " + real.name + " beside simulated snow";
  StudyTable areas;
  areas.name = "areas";
  areas.title = "Area under the curve of a forest that tells them apart; 0.5: it cannot";
  areas.columns = {"snow",
                   "all features",
                   "mounted alike, equal ranges",
                   "the same without intensity",
                   "rows judged",
                   "returns a scan",
                   "share of returns"};
  areas.rows.push_back({real.name + " (recorded)", "", "", "", "",
                        fmt::format("{:.0f}", recorded.per_scan),
                        fmt::format("{:.3f}", recorded.share)});
  std::vector<SnowLog> all = simulated;
  SnowLog plain{"plain measured law, beams of " + simulated.front().name, {}};
  for (std::size_t s = 0; s < simulated.front().scans.size(); ++s)
    plain.scans.push_back(
        plainSnow(simulated.front().scans[s], params.plain_mm_h, {params.seed, s, 0, 0}));
  all.push_back(std::move(plain));
  std::size_t number = 0;
  for (const SnowLog& log : all) {
    const Halves halves = halvesOf(log.scans, params), alike = halvesOf(log.scans, params, true);
    const Judgment whole = judge(recorded, halves, {0, {}, true}, params);
    const auto area = [&](const std::vector<std::size_t>& hidden) {
      const View view{params.range_bin, hidden, false};
      return areaText(judge(recorded_alike, alike, view, params));
    };
    areas.rows.push_back({log.name, areaText(whole), area({}), area({kIntensity}),
                          fmt::format("2 x {}", whole.rows), fmt::format("{:.0f}", halves.per_scan),
                          fmt::format("{:.3f}", halves.share)});
    report.tables.push_back(featuresTable(log.name, recorded, halves, whole, ++number));
  }
  report.tables.insert(report.tables.begin(), std::move(areas));
  const SnowSector& s = params.sector;
  report.remarks = {
      fmt::format("Returns within {:g} deg of ahead, {:g} to {:g} deg of elevation and {:g} to "
                  "{:g} m, one in each {:g} x {:g} deg; as many rows of both kinds; blocks of {} "
                  "scans train and test by turns, both ways.",
                  degrees(s.azimuth), degrees(s.lowest), degrees(s.highest), s.nearest, s.farthest,
                  degrees(s.across), degrees(s.up), params.block),
      "Place and sensor differ besides the snow: what stands around (height above ground, "
      "neighbors among all returns), how the instrument codes faint echoes (intensity) and how far "
      "it sees a flake (range). Mounted alike: heights above the sensor instead; equal ranges: as "
      "many of both in every half meter."};
  return report;
}

}  // namespace perception
