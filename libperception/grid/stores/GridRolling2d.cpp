#include <algorithm>
#include <cmath>

#include "libperception/grid/flat/FlatEvidence.h"
#include "libperception/grid/flat/FlatMarks.h"
#include "libperception/grid/stores/GridRolling.h"
#include "libperception/grid/stores/RollingSquare.h"

namespace perception {
namespace {

constexpr double kForgottenFlat = 0.05;  // [log-odds] below it a cell is unknown

/// 2D grid in one flat array that rolls with the vehicle.
class GridRolling2d final : public SafetyGrid {
 public:
  explicit GridRolling2d(const GridParams& params)
      : SafetyGrid(params),
        cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
        square_(cells_),
        values_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_), 0),
        marks_(params) {}

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    T_world_ground_ = scan.T_world_ground;
    judged_ = scan.weights.size() == scan.hits.size();
    marks_.collect(scan, first_, stats);
    applyEvidence();
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite() || !started_) return 0;
    const std::int64_t x = indexOf(place.x()), y = indexOf(place.y());
    return square_.holds(first_, x, y) ? valueOf(values_[square_.slotOf(x, y)]) : 0;
  }

  std::vector<GridCell> occupiedWithin(const GridArea& area) const override {
    return within(area, cellsWhere([this](double v) { return v > params().occupied; }));
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere([](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    for (const GridCell& cell : cells) {
      const std::int64_t x = indexOf(cell.center.x()), y = indexOf(cell.center.y());
      if (!started_ || !square_.holds(first_, x, y)) continue;
      float& value = values_[square_.slotOf(x, y)];
      value = std::clamp(value + static_cast<float>(cell.log_odds),
                         static_cast<float>(params().low), static_cast<float>(params().high));
    }
  }

  template <class Wanted>
  std::vector<GridCell> cellsWhere(const Wanted& wanted) const {
    std::vector<GridCell> cells;
    if (!started_) return cells;
    const double height = params().z_max - params().z_min;
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y) {
      std::int64_t x = first_.x;
      square_.forRow(x, y, cells_, [&](std::size_t slot, std::size_t count) {
        for (std::size_t i = slot; i < slot + count; ++i, ++x)
          if (const double v = valueOf(values_[i]); wanted(v))
            cells.push_back(
                {centerOf(x, y), {params().resolution, params().resolution, height}, v});
      });
    }
    return cells;
  }

  std::size_t memoryBytes() const override {
    return values_.capacity() * sizeof(float) + marks_.memoryBytes() + sizeof *this;
  }

 private:
  std::int64_t indexOf(double v) const {
    return static_cast<std::int64_t>(std::floor(v / params().resolution));
  }
  double valueOf(float v) const {
    return std::abs(v) < static_cast<float>(kForgottenFlat) ? 0 : static_cast<double>(v);
  }
  // Centered in the slab above the vehicle's ground plane.
  Vector3 centerOf(std::int64_t x, std::int64_t y) const {
    const double res = params().resolution;
    const Vector3 origin = T_world_ground_.translation(), up = T_world_ground_.linear().col(2);
    const double px = (static_cast<double>(x) + 0.5) * res;
    const double py = (static_cast<double>(y) + 0.5) * res;
    const double ground =
        up.z() > 0.1 ? -(up.x() * (px - origin.x()) + up.y() * (py - origin.y())) / up.z() : 0;
    return {px, py, origin.z() + ground + (params().z_min + params().z_max) / 2};
  }

  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 center = scan.T_world_ground.translation();
    CellIndex first = windowCorner(params(), center);
    first.z = 0;
    if (!started_) now_ = scan.stamp;
    stats.late = scan.stamp < now_;
    const double age = std::max(0.0, scan.stamp - now_);
    now_ = now_ + age;
    keep_ = static_cast<float>(std::exp(-age / params().tau));
    if (started_)
      square_.forEntering(first_, first, [this](std::size_t slot, std::size_t count) {
        std::fill_n(&values_[slot], count, 0.0F);
      });
    first_ = first;
    started_ = true;
  }

  void applyEvidence() {
    FlatEvidence row{marks_.weights(0),
                     marks_.crossed(0),
                     keep_,
                     static_cast<float>(params().hit),
                     static_cast<float>(params().miss),
                     static_cast<float>(params().low),
                     static_cast<float>(params().high),
                     judged_ ? 1.0F : 0.0F};
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y)
      square_.forRow(first_.x, y, cells_, [&](std::size_t slot, std::size_t count) {
        addEvidence(&values_[slot], count, row);
        row.weights += count, row.crossed += count;
      });
  }

  int cells_;
  RollingSquare square_;
  std::vector<float> values_;  // [log-odds], by world index modulo the window
  FlatMarks marks_;
  Pose3 T_world_ground_ = Pose3::Identity();
  bool judged_ = false;  // the hits of the scan have weights
  bool started_ = false;
  Stamp now_;
  float keep_ = 1;  // factor of decay of the scan
  CellIndex first_;
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridRolling2d(const GridParams& params) {
  return std::make_unique<GridRolling2d>(params);
}

}  // namespace perception
