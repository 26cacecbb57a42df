#pragma once
#include <cstdint>
#include <vector>

#include "libperception/core/Frames.h"

namespace perception {

struct PersonParams;

/// The kernel L(r) [1/m^2] at distance r [m], method.md (49).
double personKernel(double r, const PersonParams& params);

/// Response of the person filter on a grid: at the center of every square cell the sum of the
/// kernel over the returns, each moved to the center of its cell.
class PersonResponse {
 public:
  /// Positions of the returns [m]; `weight` as for findPersons().
  PersonResponse(const std::vector<float>& x, const std::vector<float>& y,
                 const std::vector<float>& weight, const PersonParams& params);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  std::size_t margin() const { return margin_; }                  ///< empty cells at each side
  double cell() const { return cell_; }                           ///< [m]
  const std::vector<float>& values() const { return response_; }  ///< row-major
  const std::vector<float>& weights() const { return weights_; }  ///< of the returns in each cell
  /// The cell of every return, in their order.
  const std::vector<std::uint32_t>& cellOfReturn() const { return cell_of_return_; }
  Vector2 center(std::size_t k) const {
    return {x0_ + (static_cast<double>(k % columns_) + 0.5) * cell_,
            y0_ + (static_cast<double>(k / columns_) + 0.5) * cell_};
  }
  /// Local maxima: cells with a response of at least `least` > 0 that is not below any of the eight
  /// neighbors (of equal ones the first) and with returns in or beside them; in the order of the
  /// grid.
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
