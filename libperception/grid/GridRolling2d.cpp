#include <algorithm>
#include <cmath>
#include <cstring>

#include "libperception/core/Wider.h"
#include "libperception/grid/FlatBeams.h"
#include "libperception/grid/GridRolling.h"
#include "libperception/grid/ScanEvidence.h"

namespace perception {
namespace {

constexpr double kForgotten = 0.05;  // [log-odds] as good as unknown
constexpr float kTrusted = 0.5F;     // a hit below does not end a beam: what lies behind was seen
constexpr int kWhole = 255;          // weight of a hit in a mark

/// What cells of a row keep and take in.
struct RowEvidence {
  std::uint8_t *weights, *crossed;  ///< of 255; 0 or 1; used up
  float keep;                       ///< share of the log-odds that is not forgotten
  float hit, miss, low, high;       ///< [log-odds]
  float voided;                     ///< share of voidedBy(): 1 where hits are judged
};

PERCEPTION_WIDER void addHits(float* __restrict values, std::uint8_t* __restrict weights,
                              std::uint8_t* __restrict crossed, std::size_t count,
                              const RowEvidence e) {
  for (std::size_t i = 0; i < count; ++i) {
    const float w = static_cast<float>(weights[i]) * (1.0F / kWhole), v = values[i] * e.keep;
    const float left = v < 0 ? v - v * w * e.voided : v;
    const float miss = static_cast<float>(crossed[i]) * ((1 - w) * e.miss);
    const float sum = left + (w * e.hit + miss);
    const float bounded = sum < e.low ? e.low : sum;
    values[i] = bounded > e.high ? e.high : bounded;
    weights[i] = 0, crossed[i] = 0;
  }
}

PERCEPTION_WIDER void addMisses(float* __restrict values, std::uint8_t* __restrict crossed,
                                std::size_t count, const RowEvidence e) {
  for (std::size_t i = 0; i < count; ++i) {
    const float sum = values[i] * e.keep + static_cast<float>(crossed[i]) * e.miss;
    values[i] = sum < e.low ? e.low : sum;
    crossed[i] = 0;
  }
}

// Most stretches of a row have no hit.
void addRow(float* values, std::size_t count, RowEvidence e) {
  constexpr std::size_t kStretch = 32;
  static constexpr std::uint8_t kNone[kStretch] = {};
  for (std::size_t i = 0; i < count; i += kStretch) {
    const std::size_t length = std::min(kStretch, count - i);
    if (std::memcmp(e.weights + i, kNone, length) == 0) {
      addMisses(values + i, e.crossed + i, length, e);
    } else {
      addHits(values + i, e.weights + i, e.crossed + i, length, e);
    }
  }
}

/// What hits weigh, and which of them stop a beam.
PERCEPTION_WIDER void weigh(const PlacedBlock& placed, const float* __restrict weights,
                            std::size_t count, std::int32_t* __restrict stops,
                            std::int32_t* __restrict marks) {
  const std::int32_t* __restrict in_slab = placed.in_slab.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float w = weights[i] < PlacedBlock::kFullWeight ? weights[i] : 1;  // no verdict: believe
    stops[i] = in_slab[i] & (w >= kTrusted);
    marks[i] = static_cast<std::int32_t>((w > 0 ? w : 0) * kWhole + 0.5F);
  }
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
        beams_(params.ray_step, cells_) {}

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    T_world_ground_ = scan.T_world_ground;
    frame_ = WindowFrame(params(), scan.T_world_ground, first_, cells_, 0);
    judged_ = scan.weights.size() == scan.hits.size();
    rays_ = scan.origin.allFinite();
    beams_.begin(frame_.place(rays_ ? scan.origin : scan.T_world_ground.translation()));
    takeHits(scan, stats);
    stats.not_finite +=
        beams_.offerClear(scan.clear, frame_, static_cast<std::uint32_t>(scan.hits.size()));
    if (rays_) {
      const auto place = [&](std::uint32_t i) {
        return frame_.place(i < scan.hits.size() ? scan.hits[i] : scan.clear[i - scan.hits.size()]);
      };
      stats.rays += beams_.cross(place, crossed_.data());
    }
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
           beams_.memoryBytes() + sizeof *this;
  }

 private:
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
    keep_ = static_cast<float>(std::exp(-age / params().tau));
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

  void takeHits(const GridScan& scan, GridStats& stats) {
    constexpr std::size_t kSize = PlacedBlock::kSize;
    const std::vector<float> full(judged_ ? 0 : kSize, 1.0F);
    PlacedBlock::Lane<std::int32_t> stops, marks;
    std::int32_t settled = PlacedBlock::kOutside;
    for (std::size_t begin = 0; begin < scan.hits.size(); begin += kSize) {
      const std::size_t count = std::min(kSize, scan.hits.size() - begin);
      const float* weights = judged_ ? &scan.weights[begin] : full.data();
      frame_.place(scan.hits, begin, count, placed_);
      weigh(placed_, weights, count, stops.data(), marks.data());
      beams_.offerHits(placed_, stops.data(), count, static_cast<std::uint32_t>(begin));
      placed_.chooseHits(count, weights, settled);
      settled = placed_.settled[count - 1];
      stats.hits += placed_.hits, stats.not_finite += placed_.not_finite;
      for (std::size_t i = 0; i < placed_.chosen_count; ++i) {
        const std::size_t k = placed_.chosen[i];
        if (placed_.cell[k] < 0 || placed_.in_slab[k] == 0) continue;
        const auto column = static_cast<std::size_t>(placed_.cell[k] / PlacedBlock::kLayers);
        weights_[column] = std::max(weights_[column], static_cast<std::uint8_t>(marks[k]));
      }
    }
  }

  // The window's columns are those of the array from some column on, and then from its first on.
  void addEvidence() {
    RowEvidence row{weights_.data(),
                    crossed_.data(),
                    keep_,
                    static_cast<float>(params().hit),
                    static_cast<float>(params().miss),
                    static_cast<float>(params().low),
                    static_cast<float>(params().high),
                    judged_ ? 1.0F : 0.0F};
    const auto width = static_cast<std::size_t>(cells_);
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y) {
      const std::size_t begin = slotOf(first_.x, y), behind = begin % width;
      addRow(&values_[begin], width - behind, row);
      row.weights += width - behind, row.crossed += width - behind;
      addRow(&values_[begin - behind], behind, row);
      row.weights += behind, row.crossed += behind;
    }
  }

  int cells_;
  std::vector<float> values_;  // [log-odds], by place in the world modulo the window
  std::vector<std::uint8_t> weights_, crossed_;  // of the scan, from the window's corner
  FlatBeams beams_;
  PlacedBlock placed_;
  WindowFrame frame_;
  bool rays_ = false;  // it is known where the sensor is
  Pose3 T_world_ground_ = Pose3::Identity();
  bool judged_ = false;  // the scan's hits came with weights
  bool started_ = false;
  Stamp now_;
  float keep_ = 1;  // share of what was known that is left at the scan
  CellIndex first_;
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridRolling2d(const GridParams& params) {
  return std::make_unique<GridRolling2d>(params);
}

}  // namespace perception
