#include "libperception/lidar/segments/LooseReturns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "libperception/measurement/frames/PlacedReturns.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

// All assumed.
constexpr float kBend = 0.3f;        // [m] in range, of a surface from cell to cell
constexpr int kLeastCells = 4;       // about a return that tell
constexpr float kLeastSolid = 0.3f;  // of these: the corner of a surface fills four in nine
constexpr double kMostLoose = 0.5;   // of a cluster
// What tells where the surface of a cluster begins that a cloud hangs before.
constexpr double kCloud = 0.03;       // of a cluster's returns: loose ones before the surface
constexpr float kLayer = 0.1f;        // [m] of range
constexpr double kLeastLayer = 0.25;  // of the returns of the densest layer
// What tells a surface from flakes.
constexpr int kLeastInRow = 3;     // cells that tell; where beams are far apart: one row
constexpr float kGrazing = 0.05f;  // [-] of the range: a cell of 0.4 deg on a side at 8 deg
// The same among flakes: a surface is smooth and 0.24 m wide, a cloud of flakes has depth.
constexpr float kSmooth = 0.1f;          // [m] in range
constexpr float kSmoothGrazing = 0.02f;  // [-] of the range: a side at 20 deg
// Of the directions with a return, those that have to tell: where more end well before, it is the
// back of a cloud, behind which nothing returns.
constexpr float kLeastTold = 0.5f;

/// Cells of direction about a return.
struct CellsAbout {
  int solid = 0, passed = 0;  ///< no beam, or one, returns from behind it
  int before = 0;             ///< all end well before it
  bool loose() const {
    return solid + passed >= kLeastCells &&
           static_cast<float>(solid) < kLeastSolid * static_cast<float>(solid + passed);
  }
  /// Of those that tell, solid ones; kFewDirections: too few tell, by `least` [-] of all.
  float solidShare(float least) const {
    const int told = solid + passed;
    const auto all = static_cast<float>(told + before);
    if (told < kLeastInRow || static_cast<float>(told) < least * all)
      return PlacedReturns::kFewDirections;
    return static_cast<float>(solid) / static_cast<float>(told);
  }
};

/// What counts about a return: cells whose farthest range is `least` [m] or more, as solid those up
/// to `behind` [m]. What ends nearer hides what it would tell.
struct Shell {
  float least, behind;
};

/// Of the cells up to `around` rows and columns away; the place is not at the border.
template <int around>
PERCEPTION_LANES CellsAbout cellsWithin(const DirectionCells& cells,
                                        const DirectionCells::Place& place, const Shell& shell) {
  using Float = std::conditional_t<around == 1, Float4, Float8>;
  constexpr int kNext = 64;  // three counts of up to 25 in one number
  // Cells without a return, whose range is 0, are not counted.
  const float any = std::numeric_limits<float>::denorm_min(), least = std::max(shell.least, any);
  IntsOf<Float> held{}, told{}, passed{};  // numbers below zero
  for (int row = -around; row <= around; ++row) {
    const auto farthest = load<Float>(cells.farthestFrom(place.column - around, place.row + row));
    held += farthest >= any, told += farthest >= least, passed += farthest > shell.behind;
  }
  const IntsOf<Float> counts = held + kNext * (told + kNext * passed);
  unsigned sum = 0;  // its remainders cost less than those of a signed number
  for (int lane = 0; lane <= 2 * around; ++lane) sum -= static_cast<unsigned>(counts[lane]);
  const auto all = static_cast<int>(sum % kNext), tell = static_cast<int>(sum / kNext % kNext),
             gone = static_cast<int>(sum / kNext / kNext);
  return {tell - gone, gone, all - tell};
}

/// The same at the border.
CellsAbout cellsAtBorder(const DirectionCells& cells, const DirectionCells::Place& place,
                         const Shell& shell, int around) {
  CellsAbout about;
  for (int row = place.row - around; row <= place.row + around; ++row) {
    for (int column = place.column - around; column <= place.column + around; ++column) {
      const DirectionCells::Cell cell = cells.at(column, row);
      if (cell.empty()) continue;
      ++(cell.farthest < shell.least    ? about.before
         : cell.farthest > shell.behind ? about.passed
                                        : about.solid);
    }
  }
  return about;
}

template <int around>
PERCEPTION_LANES CellsAbout cellsAbout(const DirectionCells& cells,
                                       const DirectionCells::Place& place, const Shell& shell) {
  return DirectionCells::isWithin(place) ? cellsWithin<around>(cells, place, shell)
                                         : cellsAtBorder(cells, place, shell, around);
}

PERCEPTION_LANES void sharesIn(const std::vector<std::uint32_t>& points,
                               const DirectionCells& cells, float* shares) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const float range = cells.rangeOf(points[k]);
    const bool among = range < PlacedReturns::kFlakesWithin;
    const float bend = among ? kSmooth : kBend, grazing = among ? kSmoothGrazing : kGrazing;
    const Shell shell{range - bend - grazing * range, range + bend};
    const DirectionCells::Place place = cells.placeOf(points[k]);
    const CellsAbout about =
        among ? cellsAbout<2>(cells, place, shell) : cellsAbout<1>(cells, place, shell);
    shares[k] = about.solidShare(among ? kLeastTold : 0);
  }
}

PERCEPTION_TARGET("default")
void sharesOf(const std::vector<std::uint32_t>& points, const DirectionCells& cells,
              float* shares) {
  sharesIn(points, cells, shares);
}
#if PERCEPTION_HAS_WIDER
PERCEPTION_TARGET("avx2")
void sharesOf(const std::vector<std::uint32_t>& points, const DirectionCells& cells,
              float* shares) {
  sharesIn(points, cells, shares);
}
#endif

}  // namespace

std::vector<float> solidShares(const DirectionCells& cells,
                               const std::vector<std::uint32_t>& points) {
  std::vector<float> shares(points.size());
  sharesOf(points, cells, shares.data());
  return shares;
}

namespace {

/// [m] where the surface of a cluster begins by the ranges of its returns: no nearer layer holds a
/// good part of what the densest one holds.
float surfaceBegins(std::vector<float> ranges) {
  std::sort(ranges.begin(), ranges.end());
  std::vector<std::size_t> held(ranges.size());
  for (std::size_t first = 0, end = 0; first < ranges.size(); ++first) {
    while (end < ranges.size() && ranges[end] < ranges[first] + kLayer) ++end;
    held[first] = end - first;
  }
  const double least =
      kLeastLayer * static_cast<double>(*std::max_element(held.begin(), held.end()));
  const auto begins = std::find_if(held.begin(), held.end(), [least](std::size_t count) {
    return static_cast<double>(count) >= least;
  });
  return ranges[static_cast<std::size_t>(begins - held.begin())];
}

/// Takes out of `kept` what lies before the surface of a cluster, where a cloud hangs: its densest
/// lumps let no beam pass.
void dropLumps(const EgoPoints& all, const std::vector<std::uint32_t>& points,
               std::vector<std::uint32_t>& kept) {
  const auto rangeOf = [&](std::uint32_t k) {
    const float dx = all.x[points[k]] - static_cast<float>(all.sensor.x()),
                dy = all.y[points[k]] - static_cast<float>(all.sensor.y());
    return std::sqrt(dx * dx + dy * dy);
  };
  std::vector<float> ranges;
  ranges.reserve(kept.size());
  for (const std::uint32_t k : kept) ranges.push_back(rangeOf(k));
  const float begins = surfaceBegins(std::move(ranges));
  const auto before = [&](std::uint32_t k) { return rangeOf(k) < begins; };
  std::size_t nearer = 0;
  for (std::uint32_t k = 0; k < points.size(); ++k) nearer += before(k);
  const auto lumps = static_cast<std::size_t>(std::count_if(kept.begin(), kept.end(), before));
  if (static_cast<double>(nearer - lumps) < kCloud * static_cast<double>(points.size())) return;
  kept.erase(std::remove_if(kept.begin(), kept.end(), before), kept.end());
}

}  // namespace

std::vector<std::uint32_t> surfaceReturns(const EgoPoints& all, const DirectionCells& cells,
                                          const std::vector<std::uint32_t>& points) {
  std::vector<std::uint32_t> kept;
  kept.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const Shell shell{-std::numeric_limits<float>::infinity(), cells.rangeOf(points[k]) + kBend};
    if (!cellsAbout<1>(cells, cells.placeOf(points[k]), shell).loose()) kept.push_back(k);
  }
  const auto count = static_cast<double>(points.size());
  const double loose = count - static_cast<double>(kept.size());
  if (loose > kMostLoose * count) {
    kept.resize(points.size());
    for (std::uint32_t k = 0; k < points.size(); ++k) kept[k] = k;
  } else if (loose > 0 && loose >= kCloud * count && !kept.empty()) {
    dropLumps(all, points, kept);
  }
  return kept;
}

}  // namespace perception
