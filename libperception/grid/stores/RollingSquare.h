#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "libperception/grid/stores/CellEvidence.h"

namespace perception {

/// Indexing of a square window of columns that moves with the vehicle, in an array of fixed size:
/// world index modulo the edge, so that no column is moved.
class RollingSquare {
 public:
  /// `cells`: along an edge.
  explicit RollingSquare(std::int64_t cells) : cells_(cells) {}

  std::size_t slotOf(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>(modulo(y) * cells_ + modulo(x));
  }
  bool holds(const CellIndex& first, std::int64_t x, std::int64_t y) const {
    return x >= first.x && y >= first.y && x < first.x + cells_ && y < first.y + cells_;
  }

  /// Calls `run(slot, count)` for each contiguous part (one or two) of the `count` columns from (x,
  /// y) on along x, in order.
  template <class Run>
  void forRow(std::int64_t x, std::int64_t y, std::int64_t count, const Run& run) const {
    const std::int64_t begin = modulo(x), straight = std::min(count, cells_ - begin);
    if (count <= 0) return;
    const auto row = static_cast<std::size_t>(modulo(y) * cells_);
    run(row + static_cast<std::size_t>(begin), static_cast<std::size_t>(straight));
    if (straight < count) run(row, static_cast<std::size_t>(count - straight));
  }

  /// The same for all columns in the square from `now` on that are not in the one from `old` on.
  template <class Run>
  void forEntering(const CellIndex& old, const CellIndex& now, const Run& run) const {
    for (std::int64_t y = now.y; y < now.y + cells_; ++y) {
      if (y < old.y || y >= old.y + cells_) {
        forRow(now.x, y, cells_, run);
      } else if (now.x > old.x) {
        const std::int64_t begin = std::max(now.x, old.x + cells_);
        forRow(begin, y, now.x + cells_ - begin, run);
      } else {
        forRow(now.x, y, std::min(old.x - now.x, cells_), run);
      }
    }
  }

 private:
  std::int64_t modulo(std::int64_t i) const {
    const std::int64_t rest = i % cells_;
    return rest < 0 ? rest + cells_ : rest;
  }

  std::int64_t cells_;
};

}  // namespace perception
