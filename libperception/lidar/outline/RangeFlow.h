#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace perception {

/// The ranges that two scans show in cells of direction, and by which way most of the cells say
/// that what they show has moved.
class RangeFlow {
 public:
  static constexpr std::size_t kMostInCell = 6;  ///< returns of each scan
  static constexpr double kFastest = 45;         ///< [m/s] of a road user (assumed)

  explicit RangeFlow(std::size_t cells) : now_(cells), before_(cells) {}

  void addNow(std::size_t cell, float range) { now_[cell].add(range); }
  /// Only where returns of now are.
  void addBefore(std::size_t cell, float range) {
    if (now_[cell].n > 0) before_[cell].add(range);
  }
  /// The way [m] away from the sensor since the scan before, `dt` [s] ago. Empty: it is slow, too
  /// few cells tell, or they disagree.
  std::optional<double> way(double dt) const;
  bool seenBefore(std::size_t cell) const { return before_[cell].n > 0; }
  /// Whether the scan before has a return in the cell that is nearer by the way than `range`.
  bool agrees(std::size_t cell, float range, double way) const;

 private:
  struct Ranges {
    std::array<float, kMostInCell> range{};
    std::size_t n = 0;
    void add(float r) {
      if (n < kMostInCell) range[n++] = r;
    }
  };

  std::vector<Ranges> now_, before_;  ///< by cell
};

}  // namespace perception
