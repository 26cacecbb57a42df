#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace perception {

/// How far along each direction beams have already crossed this scan's cells. Directions are binned
/// so finely that beams of one bin pass through the same cells but for corners, coarser near the
/// sensor, where beams lie close to each other: from octave to octave of the distance bins halve in
/// number and lie within each other. So a scan costs by what it sees and not by its beams.
class BeamCover {
 public:
  static constexpr int kFinest = 7, kCoarsest = 2;  ///< octave k reaches to 2^k cells, the last on
  /// Bins across and upwards per cell at the far end of an octave.
  static constexpr float kAcross = 1.5F, kUp = 1.5F;
  /// Bins across of a face in the finest octave.
  static constexpr int kFaceBins = static_cast<int>(2 * kAcross * (1 << kFinest));

  /// `cells`, `layers`: of the window.
  BeamCover(int cells, int layers);

  /// Forgets the last scan. `height`: [cells] of the sensor above the window's bottom.
  void begin(float height);

  /// [cells] from where on a beam crosses what no other has crossed; it takes it up to `to` from
  /// now on. Nothing is left where the result is not below `to`. `across`, `up`: the beam's bins in
  /// the finest octave.
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
  /// [cells] where it begins, per step of a mark; and where its bins begin in the table.
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
  std::vector<std::uint8_t> reached_;  // 0: not at all; [octave][face][across][up]
};

}  // namespace perception
