#pragma once
#include <cstddef>
#include <vector>

#include "libperception/simd/Simd.h"

namespace perception {

/// Quantities of many filters as structure of arrays: one plane per quantity, contiguous, aligned
/// and padded to whole SIMD vectors.
class Planes {
 public:
  Planes(std::size_t size, std::size_t planes);
  std::size_t size() const { return size_; }
  std::size_t padded() const { return padded_; }
  double* operator[](std::size_t plane) { return values_.data() + offset_ + plane * padded_; }
  const double* operator[](std::size_t plane) const {
    return values_.data() + offset_ + plane * padded_;
  }
  Planes(const Planes&) = delete;  // the copy's values would be aligned elsewhere
  Planes& operator=(const Planes&) = delete;
  Planes(Planes&&) = default;
  Planes& operator=(Planes&&) = default;

 private:
  std::size_t size_, padded_;
  std::vector<double> values_;  ///< with room to align
  std::size_t offset_;          ///< of the first aligned value
};

/// Many Gaussians of four state variables as structure of arrays. Planes 0-3: x; 4-13: the upper
/// triangle of P, row by row.
struct BankBatch : Planes {
  explicit BankBatch(std::size_t size) : Planes(size, 14) {}
};

/// Transition and process noise of each Gaussian of a batch over its own time step (see
/// predictClassFilter).
struct MotionBatch : Planes {
  enum Plane {
    kDecay,        ///< v(t + dt) / v(t)
    kEffectiveDt,  ///< [s] distance covered / initial speed
    kPp,           ///< [m^2] position noise along the motion: psd times the integrals of the step
    kPv,           ///< [m^2/s]
    kVv,           ///< [m^2/s^2]
    kSlip,         ///< [m^2] position noise in all directions
    kYawPp,        ///< [s^2 rad^2] yaw-rate noise: times v^2 a position noise across the motion
    kYawPy,        ///< [s rad^2]
    kYawYy,        ///< [rad^2]
    kPlanes
  };
  explicit MotionBatch(std::size_t size) : Planes(size, kPlanes) {}
};

/// A range of a batch, for parallel or cache-sized processing. `first` and, except in the last
/// part, `end` are multiples of kPart.
struct BatchPart {
  static constexpr std::size_t kPart = 64;
  std::size_t first = 0, end = static_cast<std::size_t>(-1);  ///< the default: all
};

/// [x, y, vx, vy] at constant velocity (method.md 3.1).
void predictConstantVelocity(const MotionBatch& motion, BankBatch& bank, SimdLevel level,
                             BatchPart part = {});
/// [x, y, v, theta]; theta is not wrapped (method.md 3.2).
void predictWheeled(const MotionBatch& motion, BankBatch& bank, SimdLevel level,
                    BatchPart part = {});
/// The same by the exact moments of an uncertain heading.
void predictMoments(const MotionBatch& motion, BankBatch& bank, SimdLevel level,
                    BatchPart part = {});

}  // namespace perception
