#include "libperception/grid/GridRolling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "libperception/grid/WindowMarks.h"

namespace perception {
namespace {

constexpr double kUnits = 2048;      // per log-odd: 7 + 5, the largest sum, stays below 32767
constexpr double kForgotten = 0.05;  // [log-odds] as good as unknown: decay by rounding ends there
constexpr int kGroup = 4;            // layers worked on at once

using Short4 = std::int16_t __attribute__((vector_size(8)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

std::int16_t units(double log_odds) {
  return static_cast<std::int16_t>(std::lround(log_odds * kUnits));
}

// The four bits of a number as four words of ones or zeros.
constexpr std::array<std::array<std::int16_t, kGroup>, 16> kSpread = [] {
  std::array<std::array<std::int16_t, kGroup>, 16> words{};
  for (std::size_t bits = 0; bits < 16; ++bits)
    for (std::size_t k = 0; k < kGroup; ++k) words[bits][k] = bits >> k & 1 ? -1 : 0;
  return words;
}();

Short4 spread(unsigned bits) {
  Short4 words;
  std::memcpy(&words, kSpread[bits & 15].data(), sizeof words);
  return words;
}

int layersOf(const GridParams& params) {
  const double spread = 2 * params.grade * params.size * std::sqrt(0.5);
  const double layers = (params.z_max - params.z_min + spread) / params.resolution;
  return std::min(64, kGroup * static_cast<int>(std::ceil((layers - 1e-6) / kGroup)));
}

std::int64_t modulo(std::int64_t a, std::int64_t n) { return ((a % n) + n) % n; }

/// A cell's place in the array is its place in the world modulo the window's size, so nothing is
/// moved when the vehicle does. Columns carry the time of their last change and decay when touched.
template <class Mask>
class GridRolling final : public SafetyGrid {
 public:
  explicit GridRolling(const GridParams& params)
      : SafetyGrid(params),
        cells_(static_cast<std::int64_t>(std::ceil(params.size / params.resolution))),
        layers_(layersOf(params)),
        marks_(params, static_cast<int>(layers_)),
        values_(static_cast<std::size_t>(cells_ * cells_ * layers_), 0),
        times_(static_cast<std::size_t>(cells_ * cells_), 0) {
    hit_ = units(params.hit), miss_ = units(params.miss);
    low_ = units(params.low), high_ = units(params.high);
  }

  GridStats insert(const GridScan& scan) override {
    GridStats stats;
    if (!scan.T_world_ground.matrix().allFinite()) return stats;
    advance(scan, stats);
    marks_.collect(scan, first_, stats);
    judged_ = scan.weights.size() == scan.hits.size();
    const auto turn = static_cast<unsigned>(modulo(first_.z, layers_));
    std::size_t doubt = 0, column = 0;
    for (std::int64_t y = 0; y < cells_; ++y) {
      const std::int64_t row = modulo(first_.y + y, cells_) * cells_;
      std::int64_t slot_x = modulo(first_.x, cells_);
      for (std::int64_t x = 0; x < cells_; ++x, ++column) {
        const auto slot = static_cast<std::size_t>(row + slot_x);
        if (++slot_x == cells_) slot_x = 0;
        const Mask hit = marks_.hit(column);
        Mask crossed = marks_.crossed(column) & ~hit;
        const bool doubted =
            doubt < marks_.doubts().size() && marks_.doubts()[doubt].column == column;
        if (!(hit | crossed) && !doubted) continue;
        bringUpToNow(slot);
        for (; doubt < marks_.doubts().size() && marks_.doubts()[doubt].column == column; ++doubt)
          takeDoubt(marks_.doubts()[doubt], slot, turn, crossed);
        add(slot, turned(hit, turn), turned(crossed, turn));
        marks_.reset(column);
      }
    }
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

  std::vector<GridCell> occupiedCells() const override {
    const auto least = static_cast<std::int16_t>(params().occupied * kUnits);
    return cellsWhere(
        [=](const std::int16_t* begin, const std::int16_t* end) {
          return *std::max_element(begin, end) >= least;
        },
        [this](double v) { return v > params().occupied; });
  }
  std::vector<GridCell> knownCells() const override {
    return cellsWhere([](const std::int16_t*, const std::int16_t*) { return true; },
                      [](double v) { return v != 0; });
  }

  void restore(const std::vector<GridCell>& cells) override {
    for (const GridCell& cell : cells) {
      const CellIndex index = {indexOf(cell.centre.x()), indexOf(cell.centre.y()),
                               indexOf(cell.centre.z())};
      if (!inWindow(index)) continue;
      const std::size_t slot = slotOf(index);
      bringUpToNow(slot);
      std::int16_t& value = values_[slot * static_cast<std::size_t>(layers_) +
                                    static_cast<std::size_t>(modulo(index.z, layers_))];
      const double after = std::clamp(value / kUnits + cell.log_odds, params().low, params().high);
      value = units(after);
    }
  }

  std::size_t memoryBytes() const override {
    return values_.capacity() * sizeof(std::int16_t) + times_.capacity() * sizeof(std::int32_t) +
           marks_.memoryBytes();
  }

 private:
  std::int64_t indexOf(double v) const {
    return static_cast<std::int64_t>(std::floor(v / params().resolution));
  }
  double centreOf(std::int64_t i) const {
    return (static_cast<double>(i) + 0.5) * params().resolution;
  }
  std::size_t slotOf(const CellIndex& cell) const {
    return static_cast<std::size_t>(modulo(cell.y, cells_) * cells_ + modulo(cell.x, cells_));
  }
  bool inWindow(const CellIndex& c) const {
    return started_ && c.x >= first_.x && c.y >= first_.y && c.z >= first_.z &&
           c.x < first_.x + cells_ && c.y < first_.y + cells_ && c.z < first_.z + layers_;
  }

  /// `column_may`: a quick look at a column of values; `wanted`: at a cell's log-odds.
  template <class ColumnMay, class Wanted>
  std::vector<GridCell> cellsWhere(const ColumnMay& column_may, const Wanted& wanted) const {
    std::vector<GridCell> cells;
    if (!started_) return cells;
    for (std::int64_t y = first_.y; y < first_.y + cells_; ++y)
      for (std::int64_t x = first_.x; x < first_.x + cells_; ++x) {
        const std::size_t slot = slotOf({x, y, 0});
        const std::int16_t* values = values_.data() + slot * static_cast<std::size_t>(layers_);
        if (!column_may(values, values + layers_)) continue;
        for (std::int64_t z = first_.z; z < first_.z + layers_; ++z) {
          const double v = valueOf(values[modulo(z, layers_)], slot);
          if (wanted(v))
            cells.push_back({{centreOf(x), centreOf(y), centreOf(z)},
                             Vector3::Constant(params().resolution),
                             v});
        }
      }
    return cells;
  }

  // Moves clock and window; what enters is unknown.
  void advance(const GridScan& scan, GridStats& stats) {
    const Vector3 centre = scan.T_world_ground.translation();
    const double below = params().grade * params().size * std::sqrt(0.5) - params().z_min;
    const CellIndex first = {indexOf(centre.x()) - cells_ / 2, indexOf(centre.y()) - cells_ / 2,
                             indexOf(centre.z() - below + 1e-9)};
    if (!started_) start_ = scan.stamp;
    const auto ms = static_cast<std::int64_t>(std::llround((scan.stamp - start_) * 1000));
    stats.late = ms < now_;
    now_ = std::max(now_, ms);
    if (!started_ || std::abs(first.x - first_.x) >= cells_ ||
        std::abs(first.y - first_.y) >= cells_ || std::abs(first.z - first_.z) >= layers_ ||
        now_ > kLongestMs) {
      if (now_ > kLongestMs) start_ = scan.stamp, now_ = 0;  // after 24 days the clock starts anew
      std::fill(values_.begin(), values_.end(), std::int16_t{0});
      std::fill(times_.begin(), times_.end(), static_cast<std::int32_t>(now_));
    } else {
      enterColumns(first);
      enterLayers(first);
    }
    first_ = first;
    started_ = true;
  }

  void enterColumns(const CellIndex& first) {
    const auto forget = [this](std::int64_t x, std::int64_t y) {
      const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(slotOf({x, y, 0})) * layers_;
      std::fill(begin, begin + layers_, std::int16_t{0});
    };
    const auto isNew = [this](std::int64_t i, std::int64_t old) {
      return i < old || i >= old + cells_;
    };
    for (std::int64_t y = first.y; y < first.y + cells_; ++y) {
      if (isNew(y, first_.y)) {
        for (std::int64_t x = first.x; x < first.x + cells_; ++x) forget(x, y);
        continue;
      }
      if (first.x > first_.x)
        for (std::int64_t x = first_.x + cells_; x < first.x + cells_; ++x) forget(x, y);
      for (std::int64_t x = first.x; x < first_.x; ++x) forget(x, y);
    }
  }

  void enterLayers(const CellIndex& first) {
    for (std::int64_t z = first.z; z < first.z + layers_; ++z) {
      if (z >= first_.z && z < first_.z + layers_) continue;
      for (auto i = static_cast<std::size_t>(modulo(z, layers_)); i < values_.size();
           i += static_cast<std::size_t>(layers_))
        values_[i] = 0;
    }
  }

  double decayOver(std::int64_t ms) const {
    return std::exp(-static_cast<double>(ms) / 1000 / params().tau);
  }

  double valueOf(std::int16_t value, std::size_t slot) const {
    const double v = value / kUnits * decayOver(now_ - times_[slot]);
    return std::abs(v) < kForgotten ? 0 : v;
  }

  // Most columns were last seen in the scan before: one exponential serves them all.
  void bringUpToNow(std::size_t slot) {
    const std::int64_t age = now_ - times_[slot];
    if (age <= 0) return;
    if (age != last_age_) last_age_ = age, last_loss_ = lossOver(age);
    times_[slot] = static_cast<std::int32_t>(now_);
    const Int4 loss = {last_loss_, last_loss_, last_loss_, last_loss_};
    std::int16_t* values = values_.data() + slot * static_cast<std::size_t>(layers_);
    for (std::int64_t k = 0; k < layers_; k += kGroup, values += kGroup) {
      Short4 v;
      std::memcpy(&v, values, sizeof v);
      v -= __builtin_convertvector((__builtin_convertvector(v, Int4) * loss) >> 15, Short4);
      std::memcpy(values, &v, sizeof v);
    }
  }
  std::int32_t lossOver(std::int64_t ms) const {
    return static_cast<std::int32_t>(std::lround((1 - decayOver(ms)) * 32768));
  }

  // Bit k of a window's mask is layer first_.z + k of the world; in the array it stands modulo.
  Mask turned(Mask mask, unsigned turn) const {
    if (turn == 0) return mask;
    const auto count = static_cast<unsigned>(layers_);
    Mask all = static_cast<Mask>(~Mask{0});
    if (count < 8 * sizeof(Mask)) all = static_cast<Mask>((Mask{1} << count) - 1);
    return static_cast<Mask>((mask << turn | mask >> (count - turn)) & all);
  }

  void takeDoubt(const typename WindowMarks<Mask>::Doubt& doubt, std::size_t slot, unsigned turn,
                 Mask& crossed) {
    const Mask bit = Mask{1} << doubt.layer;
    const double w = static_cast<double>(doubt.weight);
    double log_odds = w * params().hit;
    if (crossed & bit) log_odds += (1 - w) * params().miss;
    crossed &= ~bit;
    const auto layer = static_cast<std::size_t>((doubt.layer + turn) % layers_);
    std::int16_t& value = values_[slot * static_cast<std::size_t>(layers_) + layer];
    if (judged_) log_odds += voidedBy(w, value / kUnits);
    value = std::clamp(static_cast<std::int16_t>(value + units(log_odds)), low_, high_);
  }

  void add(std::size_t slot, Mask hit, Mask crossed) {
    const Short4 hits = {hit_, hit_, hit_, hit_}, misses = {miss_, miss_, miss_, miss_};
    const Short4 low = {low_, low_, low_, low_}, high = {high_, high_, high_, high_};
    std::int16_t* values = values_.data() + slot * static_cast<std::size_t>(layers_);
    for (Mask left = hit | crossed; left != 0;
         left >>= kGroup, hit >>= kGroup, crossed >>= kGroup, values += kGroup) {
      if (!(left & 15)) continue;
      Short4 v;
      std::memcpy(&v, values, sizeof v);
      const Short4 hit_here = spread(static_cast<unsigned>(hit));
      if (judged_) v &= ~(hit_here & (v < 0));  // voidedBy()
      v += (hit_here & hits) | (spread(static_cast<unsigned>(crossed)) & misses);
      v = v < low ? low : v;
      v = v > high ? high : v;
      std::memcpy(values, &v, sizeof v);
    }
  }

  static constexpr std::int64_t kLongestMs = 0x7fffffff;

  std::int64_t cells_, layers_;
  WindowMarks<Mask> marks_;
  std::vector<std::int16_t> values_;  // [slot][layer], log-odds in units as of the column's time
  std::vector<std::int32_t> times_;   // [ms] since start_
  std::int16_t hit_ = 0, miss_ = 0, low_ = 0, high_ = 0;
  bool judged_ = false;  // the scan's hits came with weights
  bool started_ = false;
  Stamp start_;
  std::int64_t now_ = 0;  // [ms] since start_
  std::int64_t last_age_ = -1;
  std::int32_t last_loss_ = 0;
  CellIndex first_;  // lowest cell of the window
};

}  // namespace

std::unique_ptr<SafetyGrid> makeGridRolling(const GridParams& params) {
  if (layersOf(params) <= 32) return std::make_unique<GridRolling<std::uint32_t>>(params);
  return std::make_unique<GridRolling<std::uint64_t>>(params);
}

}  // namespace perception
