#pragma once
#include <vector>

#include "studies/PaperFilters.h"

namespace perception {

/// Process noises of maximum likelihood (NLopt's Nelder-Mead) over sections of positions [m], one a
/// second; R [m^2]: of the receiver. Without sections those of PaperClass.
PaperClass fitNoise(bool wheeled, const std::vector<std::vector<Vector2>>& sections,
                    const Matrix2& R);

}  // namespace perception
