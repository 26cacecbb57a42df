#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

struct PersonParams;

/// The kernel L(r) [1/m^2].
double personKernel(double r, const PersonParams& params);

/// The person filter's response over the plane: at the center of every square cell the sum of the
/// kernel over the returns, each taken at its own cell's center.
class PersonResponse {
 public:
  /// Places [m]; `weight` as for findPersons.
  PersonResponse(const std::vector<float>& x, const std::vector<float>& y,
                 const std::vector<float>& weight, const PersonParams& params);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  std::size_t margin() const { return margin_; }  ///< cells without returns at each side
  double cell() const { return cell_; }           ///< [m]
  const std::vector<float>& values() const { return response_; }  ///< row by row
  const std::vector<float>& weights() const { return weights_; }  ///< of the returns in each cell
  /// The cell of every return, in their order.
  const std::vector<std::uint32_t>& cellOfReturn() const { return cell_of_return_; }
  Vector2 center(std::size_t k) const {
    return {x0_ + (static_cast<double>(k % columns_) + 0.5) * cell_,
            y0_ + (static_cast<double>(k / columns_) + 0.5) * cell_};
  }
  /// Cells with at least `least` that are not below any of their eight neighbors (of equal ones
  /// the first) and hold returns or lie beside returns; in the order of the grid. `least` > 0.
  std::vector<std::uint32_t> maxima(float least) const;

 private:
  void place(const std::vector<float>& x, const std::vector<float>& y,
             const std::vector<float>& weight);
  void scatter(const PersonParams& params);
  bool isMaximum(std::size_t k) const;

  double cell_, x0_ = 0, y0_ = 0;  ///< [m]
  std::size_t margin_, columns_ = 0, rows_ = 0;
  std::vector<float> weights_, response_;
  std::vector<std::uint32_t> cell_of_return_;
  std::vector<std::uint32_t> occupied_;  ///< cells with returns, in the order of their first ones
};

}  // namespace perception
