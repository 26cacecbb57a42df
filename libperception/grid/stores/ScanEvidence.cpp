#include "libperception/grid/stores/ScanEvidence.h"

#include <bitset>

#include "libperception/grid/flat/FlatBlock.h"

namespace perception {

ScanEvidence::ScanEvidence(const GridParams& params, bool flat)
    : params_(params),
      cells_(static_cast<std::int64_t>(std::ceil(params.size / params.resolution))) {
  if (flat) {
    flat_.emplace(params);
  } else {
    layers_ = windowLayers(params);
    space_.emplace(params, static_cast<int>(layers_));
  }
}

const std::vector<CellEvidence>& ScanEvidence::collect(const GridScan& scan, GridStats& stats) {
  evidence_.clear();
  const bool judged = scan.weights.size() == scan.hits.size();
  moveTo(scan);
  if (space_) {
    space_->collect(scan, first_, stats);
    listSpace(judged);
  } else {
    flat_->collect(scan, first_, stats);
    listFlat(judged);
  }
  return evidence_;
}

void ScanEvidence::moveTo(const GridScan& scan) {
  first_ = windowCorner(params_, scan.T_world_ground.translation());
  if (flat_) first_.z = 0;
}

bool ScanEvidence::holds(const CellIndex& cell) const {
  const std::int64_t x = cell.x - first_.x, y = cell.y - first_.y, z = cell.z - first_.z;
  return x >= 0 && y >= 0 && z >= 0 && x < cells_ && y < cells_ && z < layers_;
}

CellIndex ScanEvidence::columnAt(std::size_t column) const {
  const auto place = static_cast<std::int64_t>(column);
  return {first_.x + place % cells_, first_.y + place / cells_, first_.z};
}

void ScanEvidence::listSpace(bool judged) {
  const auto columns = static_cast<std::size_t>(cells_ * cells_);
  // As long as it must be and no longer: memory stays flat.
  std::size_t count = space_->doubts().size();
  for (std::size_t column = 0; column < columns; ++column)
    count += std::bitset<64>(space_->hit(column) | space_->crossed(column)).count();
  evidence_.reserve(count);
  for (std::size_t column = 0; column < columns; ++column) {
    const std::uint64_t hit = space_->hit(column), crossed = space_->crossed(column);
    if ((hit | crossed) == 0) continue;
    CellIndex cell = columnAt(column);
    for (std::int64_t layer = 0; layer < layers_; ++layer, ++cell.z) {
      const bool is_hit = hit >> layer & 1, is_crossed = crossed >> layer & 1;
      if (is_hit || is_crossed) evidence_.push_back({cell, is_hit ? 1. : 0., is_crossed, judged});
    }
    space_->reset(column);
  }
  for (const auto& doubt : space_->doubts()) {
    CellIndex cell = columnAt(doubt.column);
    cell.z += doubt.layer;
    evidence_.push_back({cell, static_cast<double>(doubt.weight), doubt.crossed, judged});
  }
}

void ScanEvidence::listFlat(bool judged) {
  const auto columns = static_cast<std::size_t>(cells_ * cells_);
  std::uint8_t *weights = flat_->weights(0), *crossed = flat_->crossed(0);
  for (std::size_t column = 0; column < columns; ++column) {
    if ((weights[column] | crossed[column]) == 0) continue;
    evidence_.push_back({columnAt(column), static_cast<double>(weights[column]) / FlatBlock::kWhole,
                         crossed[column] != 0, judged});
    weights[column] = crossed[column] = 0;
  }
}

std::size_t ScanEvidence::memoryBytes() const {
  return evidence_.capacity() * sizeof(CellEvidence) + (space_ ? space_->memoryBytes() : 0) +
         (flat_ ? flat_->memoryBytes() : 0);
}

}  // namespace perception
