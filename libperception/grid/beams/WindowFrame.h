#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "libperception/core/Frames.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/beams/BeamBlock.h"
#include "libperception/grid/beams/GridPoints.h"
#include "libperception/grid/beams/SelectedIndices.h"
#include "libperception/grid/stores/CellEvidence.h"

namespace perception {

/// Layers of the window: the slab, widened by the grade up to the window's corners; a multiple of
/// four, 64 at most.
int windowLayers(const GridParams& params);
/// Lowest cell of the window around a place [m, world] on the ground.
CellIndex windowCorner(const GridParams& params, const Vector3& center);

/// A block of points of a scan in a window.
struct PlacedBlock {
  static constexpr std::size_t kSize = 256;
  static constexpr std::int32_t kLayers = 64;  ///< cell = column * kLayers + layer
  static constexpr std::int32_t kOutside = -1, kNotFinite = -2;
  static constexpr float kFullWeight = 0.99F;  ///< a hit of at least this weight has weight 1
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<float> x, y, z, low, high;  ///< as in WindowPlace
  Lane<std::int32_t> cell;         ///< or kOutside, kNotFinite
  Lane<std::int32_t> in_slab;      ///< 0 or 1
  std::size_t not_finite = 0;      ///< how many

  // Results of chooseHits() and chooseClear().
  SelectedIndices chosen;
  std::size_t hits = 0;        ///< number of hits within the window
  Lane<std::int32_t> settled;  ///< the cell, if further points in it are redundant, else kOutside

  /// Skips redundant hits: those in the cell of the previous one if that was within the slab and of
  /// full weight. `weights`: null when all are 1. `before`: settled cell of the point before the
  /// first one.
  void chooseHits(std::size_t count, const float* weights, std::int32_t before);
  /// Skips points in the cell of the previous one.
  void chooseClear(std::size_t count, std::int32_t before);

  WindowPlace at(std::size_t k) const { return {x[k], y[k], z[k], low[k], high[k]}; }

 private:
  void leaveOut(std::size_t count, std::int32_t before);
};

/// Bounds for points, in cells from the window's corner and meters above the ground.
struct WindowRules {
  float slope_x = 0, slope_y = 0, slope_z = 1, offset = 0;  ///< [m] of height per cell; [m]
  float center_x = 0, center_y = 0;                         ///< [cells] position of the vehicle
  float z_min = 0, z_max = 0;                               ///< [m]
  float grade = 0;                                          ///< [m] per cell
  float cells = 0, layers = 0;
};

/// Position of the base of points in a window [cells], and cells per meter.
struct PointOffset {
  float x, y, z;
  float per_meter;
};

/// Transform from world to window, and the height slab in it.
class WindowFrame {
 public:
  WindowFrame() = default;
  /// `first`: lowest cell of the window. `layers` 0: all heights are inside.
  WindowFrame(const GridParams& params, const Pose3& T_world_ground, const CellIndex& first,
              int cells, int layers);

  /// Converts at most PlacedBlock::kSize points from `first` on.
  void place(const GridPoints& points, std::size_t first, std::size_t count,
             PlacedBlock& out) const;
  PointOffset offsetOf(const GridPoints& points) const;
  const WindowRules& rules() const { return rules_; }
  /// `point`: [m] world.
  WindowPlace place(const Vector3& point) const;

 private:
  double per_meter_ = 1;
  double corner_[3] = {0, 0, 0};  ///< [m]
  WindowRules rules_;
};

}  // namespace perception
