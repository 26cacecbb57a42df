#include "libperception/grid/beams/BeamCover.h"

#include <algorithm>
#include <cmath>

namespace perception {

BeamCover::BeamCover(int cells, int layers)
    // Beams within the layers at the begin of an octave rise by at most twice that at its end.
    : rows_(static_cast<std::int32_t>(2 * kUp * static_cast<float>(layers)) + 2) {
  constexpr float kMarks = 254;  // steps of a mark from begin to end of an octave
  std::size_t first = 0;
  for (int k = kFinest; k >= kCoarsest; --k) {
    Octave& octave = octaves_[k];
    octave.begin = k == kCoarsest ? 0 : static_cast<float>(1 << (k - 1));
    const float end = static_cast<float>(k == kFinest ? std::max(2 << k, cells + 1) : 1 << k);
    octave.cells = (end - octave.begin) / kMarks;
    octave.units = 1 / octave.cells;
    octave.first = first;
    first += static_cast<std::size_t>(4 * (kFaceBins >> (kFinest - k)) * rows_);
  }
  reached_.resize(first);
}

void BeamCover::begin(float height) {
  std::fill(reached_.begin(), reached_.end(), std::uint8_t{0});
  lowest_ = static_cast<std::int32_t>(std::ceil(2 * kUp * height));
}

}  // namespace perception
