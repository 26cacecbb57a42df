#include "libperception/lidar/ground/GroundCandidates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "libperception/core/math/Angle.h"
#include "libperception/simd/Compress.h"

namespace perception {
namespace {

// A cell's returns are first counted in height bins ("steps"), so that only those of the bin that
// holds the quantile need sorting.
constexpr std::int32_t kSteps = 64;
constexpr float kStepsPerMeter = 33;   // fine at road level; the last step holds all higher returns
constexpr float kLowestStep = -0.97f;  // [m] ego frame
constexpr std::uint32_t kNoStep = ~0u;         // for a cell with too few returns
constexpr std::size_t kCandidateBlock = 1024;  // points that fit in the L1 cache

/// Polar cells in floats.
struct PolarCells {
  float a, b, c, depth;        ///< the plane; [m] below it returns are mirrored
  float near, far;             ///< [m]
  float per_ring, per_sector;  ///< [1/m, 1/rad]
  std::int32_t rings, sectors;
};

/// Cell and height step of each point, cell rings x sectors for points in none; without branches,
/// so that the compiler vectorizes it.
PERCEPTION_WIDEST void findSteps(const float* __restrict xs, const float* __restrict ys,
                                 const float* __restrict zs, std::size_t count, const PolarCells k,
                                 std::uint32_t* __restrict steps) {
  for (std::size_t i = 0; i < count; ++i) {
    const float x = xs[i], y = ys[i], range = std::sqrt(x * x + y * y);
    const std::int32_t counts =
        (range >= k.near) & (range < k.far) & (zs[i] >= k.a * x + k.b * y + k.c - k.depth);
    const auto turn = static_cast<std::int32_t>((fastAtan2(x, y) + 3.14159265f) * k.per_sector);
    const std::int32_t sector = turn >= k.sectors ? 0 : turn;
    const auto out = static_cast<std::int32_t>(range * k.per_ring);
    const std::int32_t ring = out < k.rings - 1 ? out : k.rings - 1;
    const std::int32_t cell = counts != 0 ? sector * k.rings + ring : k.rings * k.sectors;
    const float up = (zs[i] - kLowestStep) * kStepsPerMeter;
    const float bounded = up > 0 ? up : 0;
    const auto step = static_cast<std::int32_t>(bounded < kSteps - 1.0f ? bounded : kSteps - 1.0f);
    steps[i] = static_cast<std::uint32_t>(cell * kSteps + step);
  }
}

/// Marks the points in the selected steps, one step per cell.
PERCEPTION_WIDER void markWanted(const std::uint32_t* __restrict steps, std::size_t count,
                                 const std::uint32_t* __restrict wanted,
                                 std::int32_t* __restrict marks) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto cell = static_cast<std::int32_t>(steps[i] / kSteps);
    marks[i] = wanted[cell] == steps[i];
  }
}

/// A sort key: height z, then index i.
std::uint64_t byHeight(float z, std::uint32_t i) {
  const float no_negative_zero = z + 0.0f;
  std::uint32_t bits;
  std::memcpy(&bits, &no_negative_zero, sizeof bits);
  bits ^= (bits >> 31) != 0 ? 0xFFFFFFFFu : 0x80000000u;
  return std::uint64_t{bits} << 32 | i;
}

/// Selection in a cell: rank of the candidate within its step, and the output range of the step's
/// returns.
struct Search {
  std::uint32_t cell, below, first, end;
};

/// For each cell the step that contains its quantile.
std::vector<Search> searchesIn(const std::vector<std::uint32_t>& counts,
                               const CandidateRules& rules, std::vector<std::uint32_t>& wanted) {
  std::vector<Search> searches;
  std::uint32_t first = 0;
  for (std::uint32_t cell = 0; cell + 1 < wanted.size(); ++cell) {
    const std::uint32_t* of_steps = &counts[static_cast<std::size_t>(cell) * kSteps];
    std::uint32_t count = 0;
    for (int step = 0; step < kSteps; ++step) count += of_steps[step];
    if (count < static_cast<std::uint32_t>(rules.cell_points)) continue;
    auto below = static_cast<std::uint32_t>(rules.quantile * static_cast<double>(count));
    std::uint32_t step = 0;
    for (; below >= of_steps[step]; ++step) below -= of_steps[step];
    wanted[cell] = cell * kSteps + step;
    searches.push_back({cell, below, first, first});
    first += of_steps[step];
  }
  return searches;
}

}  // namespace

GroundCandidates groundCandidates(const EgoPoints& points, const CandidateRules& rules) {
  const int rings = static_cast<int>(std::ceil(rules.range_max / rules.ring));
  const auto cells = static_cast<std::size_t>(rings) * static_cast<std::size_t>(rules.sectors);
  const PolarCells polar{static_cast<float>(rules.plane.a),
                         static_cast<float>(rules.plane.b),
                         static_cast<float>(rules.plane.c),
                         static_cast<float>(rules.depth),
                         static_cast<float>(rules.range_min),
                         static_cast<float>(rules.range_max),
                         static_cast<float>(1 / rules.ring),
                         static_cast<float>(rules.sectors / kTwoPi),
                         rings,
                         rules.sectors};
  const std::size_t count = points.size();
  thread_local std::vector<std::uint32_t> step_of, counts;  // reused between scans
  step_of.resize(count), counts.assign((cells + 1) * kSteps, 0);
  findSteps(points.x.data(), points.y.data(), points.z.data(), count, polar, step_of.data());
  // Neighbors in a scan increment the same counter; interleaving four parts of the scan avoids that
  // dependency.
  const std::size_t quarter = count / 4;
  for (std::size_t i = 0; i < quarter; ++i)
    ++counts[step_of[i]], ++counts[step_of[i + quarter]], ++counts[step_of[i + 2 * quarter]],
        ++counts[step_of[i + 3 * quarter]];
  for (std::size_t i = 4 * quarter; i < count; ++i) ++counts[step_of[i]];

  std::vector<std::uint32_t> wanted(cells + 1, kNoStep), number(cells + 1, 0);
  std::vector<Search> searches = searchesIn(counts, rules, wanted);
  for (std::uint32_t k = 0; k < searches.size(); ++k) number[searches[k].cell] = k;
  std::size_t most = 0;
  for (const Search& search : searches) most += counts[wanted[search.cell]];
  std::vector<std::uint64_t> few(most);
  std::array<std::int32_t, kCandidateBlock> marks;
  std::array<std::uint32_t, kCandidateBlock + kPackSlack> found;
  for (std::size_t first = 0; first < count; first += kCandidateBlock) {
    const std::size_t size = std::min(kCandidateBlock, count - first);
    markWanted(&step_of[first], size, wanted.data(), marks.data());
    const std::size_t some =
        packPlaces(marks.data(), size, static_cast<std::uint32_t>(first), found.data());
    for (std::size_t k = 0; k < some; ++k) {
      const std::uint32_t i = found[k];
      few[searches[number[step_of[i] / kSteps]].end++] = byHeight(points.z[i], i);
    }
  }

  GroundCandidates result;
  for (auto* axis : {&result.x, &result.y, &result.z}) axis->reserve(searches.size());
  for (const Search& search : searches) {
    const auto begin = few.begin() + search.first, end = few.begin() + search.end;
    std::nth_element(begin, begin + search.below, end);
    const auto i = static_cast<std::uint32_t>(begin[search.below]);
    result.x.push_back(points.x[i]), result.y.push_back(points.y[i]);
    result.z.push_back(points.z[i]);
  }
  return result;
}

}  // namespace perception
