#include "libperception/lidar/ground/GroundSurface.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "libperception/lidar/ground/GroundTrack.h"

namespace perception {

void SurfaceParams::visit(ParamVisitor& v) {
  v.boolean("local", local,
            "track deviations of the ground from its plane; false: plane alone (Radecki et al.)");
}

namespace {

constexpr float kFar = std::numeric_limits<float>::max();
constexpr float kNoGround = std::numeric_limits<float>::quiet_NaN();
constexpr float kLowReturns = 1.0f;  // [m] above the plane: higher returns are no ground
constexpr float kMirrorMargin =
    0.30f;  // [m] below the lowest possible ground: mirrored in a wet road (method.md 8.1)

// The last bits of a height hold its place in the ring; at 10 m they are less than .1 mm.
constexpr std::int32_t kPlaces = 64;

std::int32_t bitsOfHeight(float height) {
  std::int32_t bits;
  std::memcpy(&bits, &height, sizeof bits);
  return bits;
}

/// [0, 1] place in the ring of a marked height.
float placeOf(float height) {
  return (static_cast<float>(bitsOfHeight(height) & (kPlaces - 1)) + 0.5f) / kPlaces;
}

float medianOfThree(float a, float b, float c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

GroundSurface::GroundSurface(const GroundPlane& plane, const EgoPoints& points,
                             const SurfaceParams& params, std::vector<float>* heights)
    : plane_(plane),
      sensor_x_(static_cast<float>(points.sensor.x())),
      sensor_y_(static_cast<float>(points.sensor.y())),
      departure_(1, 0.0f),
      rise_(1, 0.0f) {
  const bool local = params.local && points.size() > 0;
  if (local) {
    sectors_ = static_cast<std::size_t>(params.sectors);
    rings_ = 1 + static_cast<std::size_t>(points.reach / params.ring);
    inverse_ring_ = static_cast<float>(1 / params.ring);
    inverse_sector_ = static_cast<float>(params.sectors / kTwoPi);
  }
  if (!local && heights == nullptr) return;
  thread_local std::vector<float> own;          // reused between scans
  thread_local std::vector<std::int32_t> cell;  // [sector][ring]
  std::vector<float>& above = heights != nullptr ? *heights : own;
  place(points, params, above, cell);
  if (local) follow(lowestOf(above, cell, params), params);
  if (heights != nullptr) subtract(cell, above);
}

namespace {

/// The constants of placeAll().
struct PlaceRules {
  float a, b, c;                  ///< the plane
  float sensor_x, sensor_y;       ///< [m]
  float rings, sectors;           ///< counts
  float per_ring, per_sector;     ///< [1/m, 1/rad]
  float bound_near, bound_slope;  ///< [m, -] of deviations from the plane
  float bend, steepest;           ///< [1/m] half the curvature, [-]
};

/// [m] largest deviation at that range.
inline float boundAt(float range, const PlaceRules& r) {
  const float bent = r.bound_slope * range + r.bend * range * range, steep = r.steepest * range;
  return r.bound_near + (bent < steep ? bent : steep);
}

/// Height above the plane and cell of each point; without branches, so that the compiler vectorizes
/// it.
PERCEPTION_WIDEST void placeAll(const float* __restrict x, const float* __restrict y,
                                const float* __restrict z, std::size_t count, PlaceRules r,
                                float* __restrict above, std::int32_t* __restrict cell) {
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - r.sensor_x, dy = y[i] - r.sensor_y;
    const float range = std::sqrt(dx * dx + dy * dy);
    const float height = z[i] - (r.a * x[i] + r.b * y[i] + r.c);
    float sector = static_cast<float>(
        static_cast<std::int32_t>((fastAtan2(dx, dy) + 3.14159265f) * r.per_sector));
    sector -= sector >= r.sectors ? r.sectors : 0.0f;
    const float all_rings = range * r.per_ring;
    const float ring = all_rings < r.rings - 1 ? all_rings : r.rings - 1;
    const auto whole = static_cast<std::int32_t>(ring);
    const auto place = static_cast<std::int32_t>(sector * r.rings) + whole;  // below 2^24: exact
    const float bound = boundAt(range, r);
    const std::int32_t low = (height <= bound + kLowReturns) & (height >= -bound - kMirrorMargin);
    const float part = ring - static_cast<float>(whole);
    std::int32_t bits;
    std::memcpy(&bits, &height, sizeof bits);
    bits = (bits & -kPlaces) | static_cast<std::int32_t>(part * kPlaces);
    std::memcpy(&above[i], &bits, sizeof bits);
    cell[i] = place ^ (low - 1);
  }
}

}  // namespace

void GroundSurface::place(const EgoPoints& points, const SurfaceParams& params,
                          std::vector<float>& above, std::vector<std::int32_t>& cell) const {
  const PlaceRules rules{static_cast<float>(plane_.a),
                         static_cast<float>(plane_.b),
                         static_cast<float>(plane_.c),
                         sensor_x_,
                         sensor_y_,
                         static_cast<float>(rings_),
                         static_cast<float>(sectors_),
                         inverse_ring_,
                         inverse_sector_,
                         static_cast<float>(params.bound_near),
                         static_cast<float>(params.bound_slope),
                         static_cast<float>(params.curvature / 2),
                         static_cast<float>(params.steepest)};
  const std::size_t count = points.size();
  above.resize(count), cell.resize(count);
  placeAll(points.x.data(), points.y.data(), points.z.data(), count, rules, above.data(),
           cell.data());
}

namespace {

/// The three lowest heights [m] of a cell; the last element holds their number as the bits of an
/// integer.
using Lowest = float __attribute__((vector_size(16)));
using Whole4 = std::int32_t __attribute__((vector_size(16)));
constexpr std::size_t kWays = 8;

inline __attribute__((always_inline)) void add(float height, Lowest& cell) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const Lowest h{height, height, height, height};
  const Lowest before =
      __builtin_shuffle(cell, Lowest{-kInfinity, kInfinity, 0, 0},
                        Whole4{4, 0, 1, 5});  // heights shifted by one; the count is kept
  const Lowest not_before = before > h ? before : h;
  const Lowest lowest = cell < not_before ? cell : not_before;
  cell = reinterpret_cast<Lowest>(reinterpret_cast<Whole4>(lowest) + Whole4{0, 0, 0, 1});
}

/// Inserts heights into their cells. Neighbors in a scan share cells; interleaving eight parts of
/// the scan avoids that dependency. Points that are not low go into a dummy cell per part.
PERCEPTION_WIDEST void addAll(const float* above, const std::int32_t* cell, std::size_t count,
                              Lowest* cells, std::size_t cell_count) {
  const std::size_t part = count / kWays;
  const auto one = [&](std::size_t i, std::size_t way) __attribute__((always_inline)) {
    const std::int32_t k = cell[i];
    add(above[i], cells[k >= 0 ? static_cast<std::size_t>(k) : cell_count + way]);
  };
  for (std::size_t i = 0; i < part; ++i)
    for (std::size_t way = 0; way < kWays; ++way) one(i + way * part, way);
  for (std::size_t i = kWays * part; i < count; ++i) one(i, 0);
}

}  // namespace

/// The quantile of each cell's low heights, at most the third lowest; none where too few are low.
std::vector<float> GroundSurface::lowestOf(const std::vector<float>& above,
                                           const std::vector<std::int32_t>& cell,
                                           const SurfaceParams& params) const {
  const std::size_t count = sectors_ * rings_;
  thread_local std::vector<Lowest> cells;
  cells.assign(count + kWays, Lowest{kFar, kFar, kFar, 0});
  addAll(above.data(), cell.data(), cell.size(), cells.data(), count);
  std::vector<float> heights(count, kNoGround);
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t low = reinterpret_cast<const Whole4&>(cells[k])[3];
    if (low < params.cell_points) continue;
    heights[k] = cells[k][std::min(static_cast<int>(params.quantile * low), 2)];
  }
  return heights;
}

/// Outward along each sector: the low height of a cell is ground if the step from the previous
/// ground cell is within bounds.
void GroundSurface::follow(const std::vector<float>& lowest, const SurfaceParams& params) {
  const auto ring = static_cast<float>(params.ring);
  const std::size_t borders = rings_ + 1;
  PlaceRules rules{};
  rules.bound_near = static_cast<float>(params.bound_near);
  rules.bound_slope = static_cast<float>(params.bound_slope);
  rules.bend = static_cast<float>(params.curvature / 2);
  rules.steepest = static_cast<float>(params.steepest);
  thread_local std::vector<float> along;  // [sector][border]
  along.resize(sectors_ * borders + 1);
  for (std::size_t s = 0; s < sectors_; ++s) {
    GroundTrack track(params, ring, &along[s * borders]);
    for (std::size_t k = 0; k < rings_; ++k) {
      const float low = lowest[s * rings_ + k];
      const float range = (static_cast<float>(k) + placeOf(low)) * ring;
      track.offer(low, range, boundAt(range, rules));
    }
    track.finish(borders);
  }
  smooth(along);
}

/// Median over neighboring sectors: removes the side of a car that was taken for ground.
void GroundSurface::smooth(const std::vector<float>& borders) {
  const std::size_t row = rings_ + 1;
  departure_.resize(sectors_ * rings_), rise_.resize(departure_.size());
  for (std::size_t s = 0; s < sectors_; ++s) {
    const float* left = &borders[(s + 1) % sectors_ * row];
    const float* middle = &borders[s * row];
    const float* right = &borders[(s + sectors_ - 1) % sectors_ * row];
    float inner = medianOfThree(left[0], middle[0], right[0]);
    for (std::size_t k = 0; k < rings_; ++k) {
      const float outer = medianOfThree(left[k + 1], middle[k + 1], right[k + 1]);
      departure_[s * rings_ + k] = inner, rise_[s * rings_ + k] = outer - inner;
      inner = outer;
    }
  }
}

namespace {

// Gathers of sixteen are slower than of eight.
PERCEPTION_WIDER void subtractAll(const std::int32_t* __restrict cell,
                                  const float* __restrict departure, const float* __restrict rise,
                                  std::size_t count, float* __restrict heights) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t k = cell[i] ^ (cell[i] >> 31);  // undoes the complement
    std::int32_t bits;
    std::memcpy(&bits, &heights[i], sizeof bits);
    const float part = (static_cast<float>(bits & (kPlaces - 1)) + 0.5f) * (1.0f / kPlaces);
    heights[i] -= departure[k] + part * rise[k];
  }
}

}  // namespace

void GroundSurface::subtract(const std::vector<std::int32_t>& cell,
                             std::vector<float>& above) const {
  subtractAll(cell.data(), departure_.data(), rise_.data(), above.size(), above.data());
}

double GroundSurface::heightAt(double x, double y) const {
  const auto dx = static_cast<float>(x) - sensor_x_, dy = static_cast<float>(y) - sensor_y_;
  const float all_rings =
      std::min(std::sqrt(dx * dx + dy * dy) * inverse_ring_, static_cast<float>(rings_) - 0.001f);
  const auto ring = static_cast<std::size_t>(all_rings);
  const auto sector =
      static_cast<std::size_t>((fastAtan2(dx, dy) + 3.14159265f) * inverse_sector_) % sectors_;
  const std::size_t k = sector * rings_ + ring;
  const float departure = departure_[k] + (all_rings - static_cast<float>(ring)) * rise_[k];
  return plane_.heightAt(x, y) + static_cast<double>(departure);
}

}  // namespace perception
