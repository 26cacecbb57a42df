#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// For each direction the distance up to which beams of this scan have already crossed cells. Bins
/// of direction are so fine that beams of a bin cross the same cells except at corners, and coarser
/// near the sensor: with each octave of distance toward it their number halves, nested. The cost of
/// a scan is then that of the cells crossed, not of its beams.
class BeamCover {
 public:
  static constexpr int kFinest = 7,
                       kCoarsest = 2;  ///< octave k ends at 2^k cells, the last one is open
  /// Bins across and upward per cell at the far end of an octave.
  static constexpr float kAcross = 1.5F, kUp = 1.5F;
  /// Bins across per face in the finest octave.
  static constexpr int kFaceBins = static_cast<int>(2 * kAcross * (1 << kFinest));

  /// `cells`, `layers`: of the window.
  BeamCover(int cells, int layers);

  /// Starts a scan. `height`: [cells] of the sensor above the window's bottom.
  void begin(float height);

  /// Distance [cells] from which a beam crosses cells that no other has crossed, and marks its
  /// direction as crossed up to `to`. Nothing remains when the result is not below `to`. `across`,
  /// `up`: the beam's bins in the finest octave.
  float take(int face, std::int32_t across, std::int32_t up, float from, float to) {
    int octave = octaveOf(to);
    float begin = to, end = to;
    while (octave >= kCoarsest && begin > from) {
      const int coarser = kFinest - octave;
      const std::int32_t row = (up >> coarser) + lowest_;
      if (row < 0 || row >= rows_) return from;
      std::uint8_t& reached =
          reached_[octaves_[octave].first +
                   static_cast<std::size_t>(
                       (face * (kFaceBins >> coarser) + (across >> coarser)) * rows_ + row)];
      const Octave& o = octaves_[octave];
      const auto mark = static_cast<std::uint8_t>(1 + static_cast<int>((end - o.begin) * o.units));
      if (reached >= mark) return begin;
      if (reached > 0) {
        begin = o.begin + static_cast<float>(reached - 1) * o.cells;
        reached = mark;
        return begin > from ? begin : from;
      }
      reached = mark;
      begin = end = o.begin;
      --octave;
    }
    return begin > from ? begin : from;
  }
  std::size_t memoryBytes() const { return reached_.capacity(); }

 private:
  /// [cells] begin and step per mark, [1/cells] marks per cell, and index of its first bin.
  struct Octave {
    float begin = 0, cells = 1, units = 1;
    std::size_t first = 0;
  };
  static int octaveOf(float to) {
    int octave = kCoarsest;
    while (octave < kFinest && to >= static_cast<float>(1 << octave)) ++octave;
    return octave;
  }

  std::int32_t rows_, lowest_ = 0;
  Octave octaves_[kFinest + 1];
  std::vector<std::uint8_t> reached_;  // 0: not crossed; [octave][face][across][up]
};

}  // namespace perception
