#pragma once
#include <cstddef>
#include <cstdint>

#include "libperception/core/Frames.h"
#include "libperception/grid/beams/WorldPlaces.h"
#include "libperception/simd/RawVector.h"

namespace perception {

/// Points of a scan as structure of arrays, in floats relative to a base near them, which keeps
/// their precision at any world coordinates.
class GridPoints {
 public:
  /// Appends `p` [m, world]. The base is the first finite point, rounded to whole meters.
  void push_back(const Vector3& p) {
    if (!based_ && p.allFinite()) base_ = p.array().round(), based_ = true;
    x_.push_back(static_cast<float>(p.x() - base_.x()));
    y_.push_back(static_cast<float>(p.y() - base_.y()));
    z_.push_back(static_cast<float>(p.z() - base_.z()));
  }
  /// Appends those `chosen` of a block.
  void append(const WorldPlaces& places, const std::uint32_t* chosen, std::size_t count) {
    std::size_t i = size();
    if (!based_) {  // up to the first finite one
      std::size_t k = 0;
      for (; k < count && !based_; ++k) push_back(places.at(chosen[k]));
      chosen += k, count -= k, i += k;
    }
    x_.resize(i + count), y_.resize(i + count), z_.resize(i + count);
    const double x = base_.x(), y = base_.y(), z = base_.z();
    for (std::size_t k = 0; k < count; ++k, ++i) {
      x_[i] = static_cast<float>(places.x[chosen[k]] - x);
      y_[i] = static_cast<float>(places.y[chosen[k]] - y);
      z_[i] = static_cast<float>(places.z[chosen[k]] - z);
    }
  }
  void emplace_back(double x, double y, double z) { push_back({x, y, z}); }
  void reserve(std::size_t count) { x_.reserve(count), y_.reserve(count), z_.reserve(count); }
  void clear() { x_.clear(), y_.clear(), z_.clear(), based_ = false; }
  /// Translates all points [m].
  void shift(const Vector3& by) { base_ += by; }

  std::size_t size() const { return x_.size(); }
  bool empty() const { return x_.empty(); }
  /// [m] world
  Vector3 operator[](std::size_t i) const {
    return base_ + Vector3(static_cast<double>(x_[i]), static_cast<double>(y_[i]),
                           static_cast<double>(z_[i]));
  }
  const Vector3& base() const { return base_; }                          ///< [m] world
  const float* x(std::size_t first) const { return x_.data() + first; }  ///< [m] from base()
  const float* y(std::size_t first) const { return y_.data() + first; }
  const float* z(std::size_t first) const { return z_.data() + first; }

 private:
  Vector3 base_ = Vector3::Zero();
  bool based_ = false;
  RawVector<float> x_, y_, z_;
};

}  // namespace perception
