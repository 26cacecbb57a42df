#include "libperception/simulation/recorded/BeamPattern.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

constexpr double kAcross = radians(0.2), kUp = radians(0.4);
constexpr int kColumns = 1800, kRows = 451;
constexpr std::uint32_t kNone = 0xffffffff;
constexpr std::uint32_t kMostInCell = 16;

/// Where a direction lies in the table of cells; beams at round angles in the middle of a cell.
struct Aim {
  double azimuth, elevation;  // [rad]
  double across, up;          // [cells]

  explicit Aim(const Vector3& direction)
      : azimuth(std::atan2(direction.y(), direction.x())),
        elevation(std::asin(std::clamp(direction.z(), -1.0, 1.0))),
        across((azimuth + kPi) / kAcross + .5),
        up((elevation + kPi / 2) / kUp + .5) {}
  int column() const { return static_cast<int>(across); }
  int row() const { return static_cast<int>(up); }
  // The neighbors that are nearest.
  int columnBeside() const { return column() + (across - column() < .5 ? -1 : 1); }
  int rowBeside() const { return row() + (up - row() < .5 ? -1 : 1); }
};

std::size_t placeOf(int column, int row) {
  const int around = (column + kColumns) % kColumns;
  return static_cast<std::size_t>(std::clamp(row, 0, kRows - 1)) * kColumns +
         static_cast<std::size_t>(around);
}

}  // namespace

void BeamPattern::see(Cell& cell) { cell.scans += cell.last != scan_, cell.last = scan_; }

std::vector<BeamPattern::Beam> BeamPattern::missing(const LidarCloud& cloud) {
  ++scan_;
  if (number_.empty()) number_.assign(static_cast<std::size_t>(kColumns) * kRows, kNone);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 place(static_cast<double>(cloud.x[i]), static_cast<double>(cloud.y[i]),
                        static_cast<double>(cloud.z[i]));
    const double range = place.norm();
    if (!(range > 0)) continue;
    const Vector3 direction = place / range;
    const Aim aim(direction);
    for (const std::size_t beside :
         {placeOf(aim.columnBeside(), aim.row()), placeOf(aim.column(), aim.rowBeside()),
          placeOf(aim.columnBeside(), aim.rowBeside())}) {
      if (number_[beside] == kNone) continue;
      Cell& other = cells_[number_[beside]];
      const double apart = std::abs(other.azimuth - aim.azimuth);
      if (std::min(apart, kTwoPi - apart) < kAcross / 2 &&
          std::abs(other.elevation - aim.elevation) < kUp / 2)
        see(other);
    }
    std::uint32_t& number = number_[placeOf(aim.column(), aim.row())];
    if (number == kNone) {
      number = static_cast<std::uint32_t>(cells_.size());
      cells_.emplace_back();
    }
    Cell& cell = cells_[number];
    cell.direction = direction, cell.azimuth = aim.azimuth, cell.elevation = aim.elevation;
    see(cell);
    ++cell.returns;
  }
  std::vector<Beam> beams;
  double due = 0;  // beams, of which whole ones are given out
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    if (cell.last == scan_) continue;
    due += cell.returns / cell.scans;
    for (std::uint32_t k = 0; due >= 1 && k < kMostInCell; ++k, --due)
      beams.push_back({cell.direction, static_cast<std::uint32_t>(c) * kMostInCell + k});
  }
  return beams;
}

}  // namespace perception
