#pragma once
#include <vector>

#include "studies/paper/PaperFilters.h"

namespace perception {

/// Maximum-likelihood process noise (NLopt's Nelder-Mead) from sections of positions [m] at 1 Hz; R
/// [m^2]: of the receiver. Without sections the defaults of PaperClass.
PaperClass fitNoise(bool wheeled, const std::vector<std::vector<Vector2>>& sections,
                    const Matrix2& R);

}  // namespace perception
