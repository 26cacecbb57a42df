#include "libperception/grid/stores/GridRolling.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "libperception/grid/beams/WindowMarks.h"
#include "libperception/grid/stores/ColumnRun.h"
#include "libperception/grid/stores/RollingSquare.h"

namespace perception {
namespace {

constexpr double kUnits = LogOddsColumn::kUnits;
constexpr double kForgottenSpace = 0.05;  // [log-odds] below it unknown: rounding stops decay

std::int64_t modulo(std::int64_t a, std::int64_t n) { return ((a % n) + n) % n; }

/// Numbers that are 0. Memory of that size comes from the system page by page when it is first
/// touched, so that a window of which a part is seen costs this part.
class ZeroedValues {
 public:
  explicit ZeroedValues(std::size_t size)
      : size_(size), values_(static_cast<std::int16_t*>(std::calloc(size, sizeof(std::int16_t)))) {
    if (!values_) throw std::bad_alloc();
  }
  std::int16_t* data() { return values_.get(); }
  const std::int16_t* data() const { return values_.get(); }
  std::int16_t* begin() { return data(); }
  std::int16_t* end() { return data() + size_; }
  std::size_t size() const { return size_; }
  std::int16_t& operator[](std::size_t i) { return values_[i]; }
  std::int16_t operator[](std::size_t i) const { return values_[i]; }

 private:
  std::size_t size_;
  struct Free {
    void operator()(std::int16_t* values) const { std::free(values); }
  };
  std::unique_ptr<std::int16_t[], Free> values_;
};

/// The index of a cell in the array is its world index modulo the window's size, so no cell is
/// moved with the vehicle. Columns store the time of their last change and decay when updated.
template <class Mask>
class GridRolling final : public SafetyGrid {
 public:
  explicit GridRolling(const GridParams& params)
      : SafetyGrid(params),
        cells_(static_cast<std::int64_t>(std::ceil(params.size / params.resolution))),
        layers_(windowLayers(params)),
        square_(cells_),
        marks_(params, static_cast<int>(layers_)),
        values_(static_cast<std::size_t>(cells_ * cells_ * layers_)),
        was_hit_(static_cast<std::size_t>(cells_ * cells_), 0),
        ages_(static_cast<std::size_t>(cells_ * cells_), params.tau),
        column_(params.hit, params.miss, params.low, params.high) {}

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    marks_.collect(scan, first_, stats);
    judged_ = scan.weights.size() == scan.hits.size();
    const auto turn = static_cast<unsigned>(modulo(first_.z, layers_));
    std::size_t column = 0;
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y)
      square_.forRow(first_.x, y, cells_, [&](std::size_t slot, std::size_t count) {
        addEvidence(column, slot, count, turn);
        column += count;
      });
    for (const auto& doubt : marks_.doubts()) applySoftHit(doubt, turn);
    return stats;
  }

  double logOdds(const Vector3& place) const override {
    if (!place.allFinite()) return 0;
    const CellIndex cell = {indexOf(place.x()), indexOf(place.y()), indexOf(place.z())};
    if (!inWindow(cell)) return 0;
    const auto slot = slotOf(cell);
    const auto layer = static_cast<std::size_t>(modulo(cell.z, layers_));
    return valueOf(values_[slot * static_cast<std::size_t>(layers_) + layer], slot);
  }

  std::vector<GridCell> occupiedWithin(const GridArea& area) const override {
    const auto least = leastOccupied();
    return cellsWhere(
        area, [=](std::size_t slot) { return was_hit_[slot] != 0 && mayReach(slot, least); }, least,
        [this](double v) { return v > params().occupied; });
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere(
        {}, [](std::size_t) { return true; }, std::numeric_limits<std::int16_t>::min(),
        [](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    empty_ = false;
    for (const GridCell& cell : cells) {
      const CellIndex index = {indexOf(cell.center.x()), indexOf(cell.center.y()),
                               indexOf(cell.center.z())};
      if (!inWindow(index)) continue;
      const std::size_t slot = slotOf(index);
      update(slot, 0, 0);
      was_hit_[slot] = 1;
      std::int16_t& value = values_[slot * static_cast<std::size_t>(layers_) +
                                    static_cast<std::size_t>(modulo(index.z, layers_))];
      const double after = std::clamp(value / kUnits + cell.log_odds, params().low, params().high);
      value = LogOddsColumn::units(after);
    }
  }

  std::size_t memoryBytes() const override {
    return values_.size() * sizeof(std::int16_t) + was_hit_.capacity() + ages_.memoryBytes() +
           marks_.memoryBytes();
  }

 private:
  std::int64_t indexOf(double v) const {
    return static_cast<std::int64_t>(std::floor(v / params().resolution));
  }
  double centerOf(std::int64_t i) const {
    return (static_cast<double>(i) + 0.5) * params().resolution;
  }
  /// Columns of the window, which begins at `first`, with centers from `low` to `high` [m].
  std::pair<std::int64_t, std::int64_t> columnsIn(std::int64_t first, double low,
                                                  double high) const {
    const double begin = centerOf(first), res = params().resolution;
    const auto count = static_cast<double>(cells_);
    const double from = std::clamp(std::ceil((low - begin) / res), 0.0, count);
    const double to = std::clamp(std::floor((high - begin) / res) + 1, from, count);
    return {first + static_cast<std::int64_t>(from), first + static_cast<std::int64_t>(to)};
  }
  std::size_t slotOf(const CellIndex& cell) const { return square_.slotOf(cell.x, cell.y); }
  bool inWindow(const CellIndex& c) const {
    return started_ && square_.holds(first_, c.x, c.y) && c.z >= first_.z &&
           c.z < first_.z + layers_;
  }

  std::int16_t leastOccupied() const {
    return static_cast<std::int16_t>(params().occupied * kUnits);
  }
  bool mayReach(std::size_t slot, std::int16_t least) const {
    return LogOddsColumn::mayReach(values_.data() + slot * static_cast<std::size_t>(layers_),
                                   static_cast<int>(layers_), least);
  }

  /// `column_may`: fast test of a column by its slot; `least`: wanted cells have no lower value;
  /// `wanted`: test of a cell's log-odds.
  template <class ColumnMay, class Wanted>
  std::vector<GridCell> cellsWhere(const GridArea& area, const ColumnMay& column_may,
                                   std::int16_t least, const Wanted& wanted) const {
    std::vector<GridCell> cells;
    if (!started_) return cells;
    const auto [x_begin, x_end] = columnsIn(first_.x, area.x_min, area.x_max);
    const auto [y_begin, y_end] = columnsIn(first_.y, area.y_min, area.y_max);
    const std::int64_t lowest = modulo(first_.z, layers_);
    for (std::int64_t y = y_begin; y < y_end; ++y) {
      std::int64_t x = x_begin;
      square_.forRow(x, y, x_end - x_begin, [&](std::size_t begin, std::size_t count) {
        for (std::size_t slot = begin; slot < begin + count; ++slot, ++x) {
          if (!column_may(slot)) continue;
          const std::int16_t* values = values_.data() + slot * static_cast<std::size_t>(layers_);
          std::int64_t layer = lowest;
          for (std::int64_t z = first_.z; z < first_.z + layers_; ++z) {
            const std::int16_t value = values[layer];
            layer = layer + 1 == layers_ ? 0 : layer + 1;
            if (value < least) continue;
            const double v = valueOf(value, slot);
            if (wanted(v))
              cells.push_back({{centerOf(x), centerOf(y), centerOf(z)},
                               Vector3::Constant(params().resolution),
                               v});
          }
        }
      });
    }
    return cells;
  }

  // Advances time and window; entering columns are unknown.
  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 center = scan.T_world_ground.translation();
    const CellIndex first = windowCorner(params(), center);
    if (!started_) now_ = scan.stamp;
    stats.late = scan.stamp < now_;
    const double passed = std::max(0.0, scan.stamp - now_);
    now_ = now_ + passed;
    ages_.advance(passed);
    if (!started_ || std::abs(first.x - first_.x) >= cells_ ||
        std::abs(first.y - first_.y) >= cells_ || std::abs(first.z - first_.z) >= layers_) {
      if (!empty_) {
        std::fill(values_.begin(), values_.end(), std::int16_t{0});
        std::fill(was_hit_.begin(), was_hit_.end(), std::uint8_t{0});
      }
      ages_.touchAll();
    } else {
      square_.forEntering(first_, first, [this](std::size_t slot, std::size_t count) {
        const auto layers = static_cast<std::size_t>(layers_);
        std::fill_n(&values_[slot * layers], count * layers, std::int16_t{0});
        std::fill_n(&was_hit_[slot], count, std::uint8_t{0});
      });
      enterLayers(first);
    }
    first_ = first;
    started_ = true;
    empty_ = false;
    ages_.refresh([this](std::size_t slot) {
      update(slot, 0, 0);
      was_hit_[slot] = was_hit_[slot] != 0 && mayReach(slot, leastOccupied());
    });
  }

  void enterLayers(const CellIndex& first) {
    for (std::int64_t z = first.z; z < first.z + layers_; ++z) {
      if (z >= first_.z && z < first_.z + layers_) continue;
      for (auto i = static_cast<std::size_t>(modulo(z, layers_)); i < values_.size();
           i += static_cast<std::size_t>(layers_))
        values_[i] = 0;
    }
  }

  double valueOf(std::int16_t value, std::size_t slot) const {
    const double v = value / kUnits * ages_.keep(slot);
    return std::abs(v) < kForgottenSpace ? 0 : v;
  }

  // Decays a column to the time of the scan and adds its evidence.
  void update(std::size_t slot, Mask hit, Mask crossed) {
    column_.update(values_.data() + slot * static_cast<std::size_t>(layers_),
                   static_cast<int>(layers_), ages_.loss(slot), hit, crossed, judged_);
    ages_.touch(slot);
  }

  // Adds the evidence of `count` columns of the window from `column` on, at `slot` in the array.
  void addEvidence(std::size_t column, std::size_t slot, std::size_t count, unsigned turn) {
    updateColumns(
        column_,
        ColumnRun<Mask>{values_.data() + slot * static_cast<std::size_t>(layers_),
                        marks_.hits(column), marks_.crossings(column), was_hit_.data() + slot, slot,
                        count, static_cast<int>(layers_), turn, judged_},
        ages_);
  }

  void applySoftHit(const typename WindowMarks<Mask>::SoftHit& doubt, unsigned turn) {
    const std::int64_t x = doubt.column % cells_, y = doubt.column / cells_;
    const std::size_t slot = slotOf({first_.x + x, first_.y + y, 0});
    update(slot, 0, 0);
    was_hit_[slot] = 1;
    const double w = static_cast<double>(doubt.weight);
    double log_odds = w * params().hit + (doubt.crossed ? (1 - w) * params().miss : 0);
    const auto layer = static_cast<std::size_t>((doubt.layer + turn) % layers_);
    std::int16_t& value = values_[slot * static_cast<std::size_t>(layers_) + layer];
    if (judged_) log_odds += voidedBy(w, value / kUnits);
    value = static_cast<std::int16_t>(std::clamp<int>(value + LogOddsColumn::units(log_odds),
                                                      LogOddsColumn::units(params().low),
                                                      LogOddsColumn::units(params().high)));
  }

  std::int64_t cells_, layers_;
  RollingSquare square_;
  WindowMarks<Mask> marks_;
  ZeroedValues values_;  // [slot][layer], log-odds in units, at the time in ages_
  /// Of each column: it was hit since it entered the window or was last refreshed below the least
  /// value of an occupied cell. Others hold no occupied cell.
  std::vector<std::uint8_t> was_hit_;
  ColumnAges ages_;
  LogOddsColumn column_;
  bool judged_ = false;  // the hits of the scan have weights
  bool started_ = false;
  bool empty_ = true;  // no value was ever set
  Stamp now_;          // of the last scan
  CellIndex first_;    // lowest cell of the window
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridRolling(const GridParams& params) {
  if (windowLayers(params) <= 32) return std::make_unique<GridRolling<std::uint32_t>>(params);
  return std::make_unique<GridRolling<std::uint64_t>>(params);
}

}  // namespace perception
