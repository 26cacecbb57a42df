#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "libperception/core/Frames.h"
#include "libperception/grid/BeamBlock.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/ScanEvidence.h"

namespace perception {

/// Some points of a scan in a window.
struct PlacedBlock {
  static constexpr std::size_t kSize = 256;
  static constexpr std::int32_t kLayers = 64;  ///< cell = column * kLayers + layer
  static constexpr std::int32_t kOutside = -1, kNotFinite = -2;
  template <class Number>
  using Lane = std::array<Number, kSize>;

  Lane<float> x, y, z, low, high;  ///< as in WindowPlace
  Lane<std::int32_t> cell;         ///< or kOutside, kNotFinite
  Lane<std::int32_t> in_slab;      ///< 0 or 1

  WindowPlace at(std::size_t k) const { return {x[k], y[k], z[k], low[k], high[k]}; }
};

/// Where a window lies in the world, and the slab of heights that matter in it.
class WindowFrame {
 public:
  WindowFrame() = default;
  /// `first`: lowest cell of the window.
  WindowFrame(const GridParams& params, const Pose3& T_world_ground, const CellIndex& first,
              int cells, int layers);

  /// `points`: [m] world, at most PlacedBlock::kSize.
  void place(const Vector3* points, std::size_t count, PlacedBlock& out) const;

 private:
  double per_metre_ = 1;
  double corner_x_ = 0, corner_y_ = 0, corner_z_ = 0;            ///< [m]
  double slope_x_ = 0, slope_y_ = 0, slope_z_ = 1, offset_ = 0;  ///< height above the ground
  double centre_x_ = 0, centre_y_ = 0;                           ///< [m] of the vehicle
  float z_min_ = 0, z_max_ = 0, grade_ = 0;                      ///< as in GridParams
  float cells_ = 0, layers_ = 0;
};

}  // namespace perception
