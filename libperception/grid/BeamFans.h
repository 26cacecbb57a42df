#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libperception/grid/BeamBlock.h"

namespace perception {

/// A stretch of a beam within the window, on its face (BeamBlock).
struct BeamStretch {
  float across, up;  ///< [-] cells aside (its amount) and upwards per cell along
  float from, to;    ///< [cells] along, from the sensor
};

/// Stretches of beams on their way to the columns that they cross. Those of nearly the same bearing
/// are a fan: at any distance they are in the same three columns at most, which are found once for
/// all of them, and whose layers are gathered before they are marked.
template <class Mask>
class BeamFans {
 public:
  /// For a window of `cells` by `cells` columns.
  explicit BeamFans(int cells);

  /// Beams come from `origin` now; none may be waiting.
  void begin(const WindowPlace& origin);
  const FanBins& bins() const { return bins_; }
  bool isFull() const { return count_ == kMost; }
  void add(std::int32_t fan, const BeamStretch& beam) {
    beams_[count_] = beam;
    fans_[count_++] = static_cast<std::uint16_t>(fan);
  }
  /// Marks the layers that the waiting stretches cross and lets them go. Columns are numbered
  /// [y][x]; margin() of them before and behind may be touched, but are left as they are.
  void mark(Mask* crossed);
  std::size_t margin() const { return 2 * static_cast<std::size_t>(cells_); }
  std::size_t memoryBytes() const;

 private:
  static constexpr std::size_t kMost = 16384;  ///< stretches that wait
  static constexpr int kOctants = 8;

  void sort();
  void markFan(int fan, Mask* crossed);

  int cells_;
  FanBins bins_;
  WindowPlace origin_{};
  std::size_t count_ = 0;
  std::vector<BeamStretch> beams_;
  std::vector<std::uint16_t> fans_;   ///< of each stretch
  std::vector<std::uint16_t> order_;  ///< stretches by fan
  std::vector<std::uint16_t> ends_;   ///< of each fan, in order_
  std::vector<float> guides_;         ///< of a fan: [group of cells along][begin, border][cell]
  std::vector<Mask> gathered_;        ///< [group of cells along][row of three][cell]
};

extern template class BeamFans<std::uint32_t>;
extern template class BeamFans<std::uint64_t>;

}  // namespace perception
