#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/beams/BeamBlock.h"

namespace perception {

/// A segment of a beam within the window, in the coordinates of its face (BeamBlock).
struct BeamStretch {
  float across, up;  ///< [-] slopes: cells across (absolute) and upward per cell along
  float from, to;    ///< [cells] along, from the sensor
};

/// Rasterizes segments of beams into columns. Segments of nearly the same bearing form a fan: at
/// any distance they lie within the same three columns, which are computed once per fan and whose
/// layers are accumulated before marking.
template <class Mask>
class BeamFans {
 public:
  /// For a window of `cells` by `cells` columns.
  explicit BeamFans(int cells);

  /// Sets the origin of the beams; no segment may be pending.
  void begin(const WindowPlace& origin);
  const FanBins& bins() const { return bins_; }
  bool isFull() const { return count_ == kMost; }
  void add(std::int32_t fan, const BeamStretch& beam) {
    beams_[count_] = beam;
    fans_[count_++] = static_cast<std::uint16_t>(fan);
  }
  /// Marks the layers crossed by the pending segments and removes these. Columns are numbered
  /// [y][x]; margin() columns before and behind may be accessed but are not changed.
  void mark(Mask* crossed);
  std::size_t margin() const { return 2 * static_cast<std::size_t>(cells_); }
  std::size_t memoryBytes() const;

 private:
  static constexpr std::size_t kMost = 65535;  ///< pending segments, by 16-bit numbers
  static constexpr int kOctants = 8;

  void sort();
  void markFan(int fan, Mask* crossed);

  int cells_;
  FanBins bins_;
  WindowPlace origin_{};
  std::size_t count_ = 0;
  std::vector<BeamStretch> beams_;
  std::vector<std::uint16_t> fans_;   ///< of each segment
  std::vector<std::uint16_t> order_;  ///< segments sorted by fan
  std::vector<std::uint16_t> ends_;   ///< end of each fan in order_
  std::vector<float> guides_;         ///< of a fan: [group of cells along][begin, border][cell]
  std::vector<Mask> gathered_;        ///< [group of cells along][row of three][cell]
};

extern template class BeamFans<std::uint32_t>;
extern template class BeamFans<std::uint64_t>;

}  // namespace perception
