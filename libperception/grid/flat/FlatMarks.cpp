#include "libperception/grid/flat/FlatMarks.h"

#include <algorithm>
#include <cmath>

namespace perception {

FlatMarks::FlatMarks(const GridParams& params)
    : params_(params),
      cells_(static_cast<int>(std::ceil(params.size / params.resolution))),
      weights_(static_cast<std::size_t>(cells_) * static_cast<std::size_t>(cells_) + 1, 0),
      crossed_(weights_.size() - 1, 0),
      beams_(params.ray_step, cells_) {}

void FlatMarks::collect(const GridScan& scan, const CellIndex& first, GridStats& stats) {
  frame_ = WindowFrame(params_, scan.T_world_ground, first, cells_, 0);
  const bool rays = scan.origin.allFinite();
  beams_.begin(frame_.place(rays ? scan.origin : scan.T_world_ground.translation()));
  addHits(scan, stats);
  stats.not_finite += beams_.offerClear(scan.clear, frame_);
  if (rays) stats.rays += beams_.cross(scan.hits, scan.clear, frame_, crossed_.data());
}

// In reverse order: scans begin with their highest beams, whose returns are farther.
void FlatMarks::addHits(const GridScan& scan, GridStats& stats) {
  const bool judged = scan.weights.size() == scan.hits.size();
  const std::size_t blocks = (scan.hits.size() + FlatBlock::kSize - 1) / FlatBlock::kSize;
  for (std::size_t block = blocks; block-- > 0;) {
    const std::size_t begin = block * FlatBlock::kSize;
    const std::size_t count = std::min(FlatBlock::kSize, scan.hits.size() - begin);
    hits_.place(scan.hits, judged ? &scan.weights[begin] : nullptr, begin, count, frame_,
                beams_.bins());
    hits_.markColumns(judged, weights_.data());
    beams_.offerHits(hits_, begin);
    stats.hits += hits_.hits, stats.not_finite += hits_.not_finite;
  }
}

std::size_t FlatMarks::memoryBytes() const {
  return weights_.capacity() + crossed_.capacity() + beams_.memoryBytes() + sizeof *this;
}

}  // namespace perception
