#include "libperception/filter/Prediction.h"

#include <cmath>

#include "libperception/core/LogMath.h"
#include "libperception/filter/MotionModels.h"

namespace perception {
namespace {

/// A track that no sensor could have seen for this long counts as out of view.
constexpr double kOutOfViewAfter = 1.0;  // [s]

}  // namespace

Track predictTrack(const Track& track, Stamp to, const FilterModel& model) {
  const double dt = to - track.stamp;
  Track next = track;
  if (dt <= 0) return next;
  next.stamp = to;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    predictClassFilter(model.classes[j], dt, next.bank[static_cast<std::size_t>(j)]);
  }
  const bool in_view = to - track.last_in_view < kOutOfViewAfter;
  const double life = in_view ? model.params.survival_in_view : model.params.survival_out_of_view;
  const double decay = model.params.existence_decay;  // to 5 % = e^-3 in this time
  next.existence *= std::exp(decay > 0 ? -3 * dt / decay : -dt / life);
  const double forget = -std::expm1(-dt / model.params.class_forgetting);
  const double uniform = std::log(forget / static_cast<double>(model.classes.size()));
  for (double& lp : next.log_class) lp = logAddExp(lp + std::log1p(-forget), uniform);
  next.base_z.variance += model.params.base_walk * dt;
  return next;
}

}  // namespace perception
