#pragma once
#include <array>
#include <vector>

#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {

constexpr double kWidestClutter = 10;  ///< [m] clutter is uniform in width up to this

/// What the visible width of a newborn says of its class (method.md 4.1).
class NewbornWidth {
 public:
  /// Borrows the classes. `width` [m]: angle between the edges times range; `noise` [m^2]: its
  /// variance. `by_shape`: of a lidar cluster that is told by what its returns look like.
  NewbornWidth(const ClassTable& classes, double width, double noise, bool by_shape = false);

  /// [1/m] of the width of the objects of a class, headings uniform.
  double density(ClassId c) const;
  /// Factor of a class in the classes of its shape, whose density together stays that of the width,
  /// by the width `across` [m] of the box. Range times angle is too little for what goes on away
  /// from the sensor: a truck beside it is 3 m wide.
  double gainInShape(ClassId c, double across) const;
  /// Factor of the shape of a class where `log_class`, the evidence by class, comes from what the
  /// returns look like: their width has spoken there already. What all classes give together stays.
  /// 1 where the width is above the average of the likeliest class that moves: that is no part.
  double gainOfShape(ClassId c, const std::vector<double>& log_class) const;

 private:
  double widthOfLikeliest(const std::vector<double>& log_class) const;
  using ByShape = std::array<double, kObjectShapes>;
  ByShape densities(ByShape& priors) const;

  const ClassTable& classes_;
  double width_, noise_;
  bool by_shape_;
};

}  // namespace perception
