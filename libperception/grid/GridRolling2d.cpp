#include <algorithm>
#include <cmath>

#include "libperception/core/Angle.h"
#include "libperception/grid/GridRolling.h"
#include "libperception/grid/ScanEvidence.h"

namespace perception {
namespace {

constexpr double kForgotten = 0.05;  // [log-odds] as good as unknown
constexpr float kTrusted = 0.5F;     // a hit below does not end a beam: what lies behind was seen
constexpr int kWhole = 255;          // weight of a hit in a mark

// atan2 within 3e-4 rad without a call: for choosing a direction's ray. Abramowitz and
// Stegun 4.4.49.
inline float roughBearing(float x, float y) {
  const float ax = std::abs(x), ay = std::abs(y);
  const float high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
  const float t = low / (high + 1e-30F), s = t * t;
  float angle =
      t * (0.9998660F + s * (-0.3302995F + s * (0.1801410F + s * (-0.0851330F + s * 0.0208351F))));
  angle = ay > ax ? 1.57079633F - angle : angle;
  angle = x < 0 ? 3.14159265F - angle : angle;
  return y < 0 ? -angle : angle;
}

/// Cells of the ground in one flat array that rolls with the vehicle; a beam a direction, up to its
/// first trusted hit or, where there is none, its farthest end.
class GridRolling2d final : public SafetyGrid {
 public:
  explicit GridRolling2d(const GridParams& params)
      : SafetyGrid(params),
        cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
        values_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0),
        weights_(values_.size(), 0),
        crossed_(values_.size(), 0),
        rays_(static_cast<std::size_t>(std::ceil(kTwoPi / params.ray_step))),
        per_radian_(static_cast<float>(static_cast<double>(rays_.size()) / kTwoPi)),
        nearest2_(static_cast<float>(params.resolution * params.resolution)) {}

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    T_world_ground_ = scan.T_world_ground;
    rays_.assign(rays_.size(), Ray{});
    takePoints(scan, stats);
    castRays(scan, stats);
    addEvidence();
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite() || !started_) return 0;
    const std::int64_t x = indexOf(place.x()) - first_.x, y = indexOf(place.y()) - first_.y;
    if (x < 0 || y < 0 || x >= cells_ || y >= cells_) return 0;
    return valueOf(values_[slotOf(x + first_.x, y + first_.y)]);
  }

  std::vector<GridCell> occupiedCells() const override {
    return cellsWhere([this](double v) { return v > params().occupied; });
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere([](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    for (const GridCell& cell : cells) {
      const std::int64_t x = indexOf(cell.centre.x()), y = indexOf(cell.centre.y());
      if (!started_ || x < first_.x || y < first_.y || x >= first_.x + cells_ ||
          y >= first_.y + cells_)
        continue;
      float& value = values_[slotOf(x, y)];
      value = std::clamp(value + static_cast<float>(cell.log_odds),
                         static_cast<float>(params().low), static_cast<float>(params().high));
    }
  }

  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const {
    std::vector<GridCell> cells;
    if (!started_) return cells;
    const double height = params().z_max - params().z_min;
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y)
      for (std::int64_t x = first_.x; x < first_.x + cells_; ++x) {
        const double v = valueOf(values_[slotOf(x, y)]);
        if (wanted(v))
          cells.push_back({centreOf(x, y), {params().resolution, params().resolution, height}, v});
      }
    return cells;
  }

  std::size_t memoryBytes() const override {
    return values_.capacity() * sizeof(float) + weights_.capacity() + crossed_.capacity() +
           rays_.capacity() * sizeof(Ray);
  }

 private:
  struct Ray {
    float range2 = 0;      // [m^2] 0: none
    float x = 0, y = 0;    // [m] from the sensor
    bool stopped = false;  // by a hit that is trusted
  };

  std::int64_t indexOf(double v) const {
    return static_cast<std::int64_t>(std::floor(v / params().resolution));
  }
  std::size_t slotOf(std::int64_t x, std::int64_t y) const {
    const auto wrap = [this](std::int64_t i) { return ((i % cells_) + cells_) % cells_; };
    return static_cast<std::size_t>(wrap(y) * cells_ + wrap(x));
  }
  double valueOf(float v) const {
    return std::abs(v) < static_cast<float>(kForgotten) ? 0 : static_cast<double>(v);
  }
  // In the middle of the slab above the vehicle's ground plane.
  Vector3 centreOf(std::int64_t x, std::int64_t y) const {
    const double res = params().resolution;
    const Vector3 origin = T_world_ground_.translation(), up = T_world_ground_.linear().col(2);
    const double px = (static_cast<double>(x) + 0.5) * res;
    const double py = (static_cast<double>(y) + 0.5) * res;
    const double ground =
        up.z() > 0.1 ? -(up.x() * (px - origin.x()) + up.y() * (py - origin.y())) / up.z() : 0;
    return {px, py, origin.z() + ground + (params().z_min + params().z_max) / 2};
  }

  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 centre = scan.T_world_ground.translation();
    const CellIndex first = {indexOf(centre.x()) - cells_ / 2, indexOf(centre.y()) - cells_ / 2, 0};
    if (!started_) now_ = scan.stamp;
    stats.late = scan.stamp < now_;
    const double age = std::max(0.0, scan.stamp - now_);
    now_ = now_ + age;
    if (age > 0) {
      const auto keep = static_cast<float>(std::exp(-age / params().tau));
      for (float& v : values_) v *= keep;
    }
    if (started_)
      for (std::int64_t y = first.y; y < first.y + cells_; ++y) {
        const bool row = y < first_.y || y >= first_.y + cells_;
        if (!row && first.x == first_.x) continue;
        for (std::int64_t x = first.x; x < first.x + cells_; ++x)
          if (row || x < first_.x || x >= first_.x + cells_) values_[slotOf(x, y)] = 0;
      }
    first_ = first;
    started_ = true;
  }

  void offerRay(float x, float y, bool stops) {
    const float range2 = x * x + y * y;
    if (!(range2 > nearest2_)) return;
    const auto bin =
        static_cast<std::uint32_t>(static_cast<int>((roughBearing(x, y) + 3.1416F) * per_radian_));
    Ray& ray = rays_[bin < rays_.size() ? bin : 0];
    const bool better = ray.stopped ? stops && range2 < ray.range2 : stops || range2 > ray.range2;
    if (better) ray = {range2, x, y, stops};
  }

  void takePoints(const GridScan& scan, GridStats& stats) {
    const bool rays = scan.origin.allFinite();
    const Vector3 origin = rays ? scan.origin : T_world_ground_.translation();
    const Vector3 up = T_world_ground_.linear().col(2), centre = T_world_ground_.translation();
    const double res = params().resolution, per_metre = 1 / res;
    const double corner_x = static_cast<double>(first_.x) * res;
    const double corner_y = static_cast<double>(first_.y) * res;
    const bool weighted = judged_ = scan.weights.size() == scan.hits.size();
    const double z_min = params().z_min, z_max = params().z_max;
    const double grade2 = params().grade * params().grade;
    const auto edge = static_cast<double>(cells_);
    for (std::size_t i = 0; i < scan.hits.size(); ++i) {
      const Vector3 p = scan.hits[i];
      const double flat_x = p.x() - centre.x(), flat_y = p.y() - centre.y();
      const double z = up.x() * flat_x + up.y() * flat_y + up.z() * (p.z() - centre.z());
      if (!std::isfinite(z)) {
        ++stats.not_finite;
        continue;
      }
      const double outside = std::max(z_min - z, z - z_max);
      const bool in_slab =
          outside <= 0 || outside * outside <= grade2 * (flat_x * flat_x + flat_y * flat_y);
      float w = weighted ? scan.weights[i] : 1.0F;
      if (!(w < 1)) w = 1;  // no verdict: believe the return
      if (w < 0) w = 0;
      const double x = (p.x() - corner_x) * per_metre, y = (p.y() - corner_y) * per_metre;
      if (in_slab && x >= 0 && y >= 0 && x < edge && y < edge) {
        ++stats.hits;
        std::uint8_t& mark =
            weights_[static_cast<std::size_t>(static_cast<int>(y) * cells_ + static_cast<int>(x))];
        mark = std::max(mark, static_cast<std::uint8_t>(w * kWhole + 0.5F));
      }
      if (rays)
        offerRay(static_cast<float>(p.x() - origin.x()), static_cast<float>(p.y() - origin.y()),
                 in_slab && w >= kTrusted);
    }
    for (const Vector3& p : scan.clear) {
      const auto x = static_cast<float>(p.x() - origin.x());
      const auto y = static_cast<float>(p.y() - origin.y());
      if (!std::isfinite(x + y + static_cast<float>(p.z()))) {
        ++stats.not_finite;
      } else if (rays) {
        offerRay(x, y, false);
      }
    }
  }

  // Amanatides and Woo, as in ScanEvidence. The last cell is not crossed: there the beam ended.
  void castRays(const GridScan& scan, GridStats& stats) {
    const auto per_metre = static_cast<float>(1 / params().resolution);
    const auto ox =
        static_cast<float>(scan.origin.x() / params().resolution - static_cast<double>(first_.x));
    const auto oy =
        static_cast<float>(scan.origin.y() / params().resolution - static_cast<double>(first_.y));
    for (const Ray& ray : rays_) {
      if (ray.range2 <= 0) continue;
      ++stats.rays;
      const float dx = ray.x * per_metre, dy = ray.y * per_metre;
      int x = static_cast<int>(std::floor(ox)), y = static_cast<int>(std::floor(oy));
      const int step_x = dx > 0 ? 1 : -1, step_y = dy > 0 ? 1 : -1;
      const float per_x = std::abs(1 / dx), per_y = std::abs(1 / dy);  // infinity: never
      float next_x = dx != 0 ? (static_cast<float>(dx > 0 ? x + 1 : x) - ox) / dx : per_x;
      float next_y = dy != 0 ? (static_cast<float>(dy > 0 ? y + 1 : y) - oy) / dy : per_y;
      while (std::min(next_x, next_y) < 1 && x >= 0 && y >= 0 && x < cells_ && y < cells_) {
        crossed_[static_cast<std::size_t>(y * cells_ + x)] = 1;
        const bool sideways = next_x < next_y;
        x += sideways ? step_x : 0, y += sideways ? 0 : step_y;
        next_x += sideways ? per_x : 0, next_y += sideways ? 0 : per_y;
      }
    }
  }

  void addEvidence() {
    const auto hit = static_cast<float>(params().hit), miss = static_cast<float>(params().miss);
    const auto low = static_cast<float>(params().low), high = static_cast<float>(params().high);
    std::size_t at = 0;
    for (std::int64_t y = 0; y < cells_; ++y) {
      const std::size_t row = slotOf(first_.x, y + first_.y);
      const std::size_t row_begin =
          row / static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_);
      std::size_t column = row - row_begin;
      for (std::int64_t x = 0; x < cells_; ++x, ++at, ++column) {
        if (column == static_cast<std::size_t>(cells_)) column = 0;
        if (!(weights_[at] | crossed_[at])) continue;
        const float w = static_cast<float>(weights_[at]) / kWhole;
        float& value = values_[row_begin + column];
        if (judged_ && value < 0) value *= 1 - w;  // voidedBy()
        value = std::clamp(value + w * hit + (crossed_[at] ? (1 - w) * miss : 0), low, high);
        weights_[at] = crossed_[at] = 0;
      }
    }
  }

  int cells_;
  std::vector<float> values_;  // [log-odds], by place in the world modulo the window
  std::vector<std::uint8_t> weights_, crossed_;  // of the scan, from the window's corner
  std::vector<Ray> rays_;                        // by bearing
  float per_radian_, nearest2_;
  Pose3 T_world_ground_ = Pose3::Identity();
  bool judged_ = false;  // the scan's hits came with weights
  bool started_ = false;
  Stamp now_;
  CellIndex first_;
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridRolling2d(const GridParams& params) {
  return std::make_unique<GridRolling2d>(params);
}

}  // namespace perception
