#pragma once
#include <nlohmann/json.hpp>

#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"

namespace perception {

/// The counts of one front end, as evaluation.json has them: by class and by bin of range; `labels`
/// by the label that the front end gave.
nlohmann::ordered_json frontEndJson(const FrontEndEvaluation& evaluation);

}  // namespace perception
