#include "libperception/filter/update/ClassDecision.h"

#include <algorithm>
#include <cmath>

#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

/// Converts the decided class's filter to another class: same position and velocity.
ClassFilter converted(const ObjectClass& from, const ClassFilter& source, const ObjectClass& to,
                      const Extent& extent) {
  ClassFilter f;
  const Kinematics k = kinematicsOf(from, source);
  const Matrix4 J = k.J.topRows<4>();
  f.extent = extent;
  f.x = k.q.head<4>();
  f.P = J * source.P * J.transpose();
  if (!to.motion->moves) {
    f.x.tail<2>().setZero();
    f.P.rightCols<2>().setZero();
    f.P.bottomRows<2>().setZero();
    return f;
  }
  if (!from.motion->moves) {
    const double sigma = 0.5 * std::min(to.max_speed, 1.0);  // [m/s] it stood until now
    f.P(2, 2) = f.P(3, 3) = sigma * sigma;
  }
  if (to.motion->has_heading && source.oriented) {
    f.x = source.x, f.P = source.P;
    f.oriented = true;
    f.heading = source.heading;
  }
  startModes(to, f);
  return f;
}

}  // namespace

void decideClass(const FilterModel& model, bool surprised, Track& track) {
  if (model.params.decide_class <= 0) return;
  const ClassId best = track.likeliestClass();
  const bool sure = !surprised && std::exp(track.log_class[static_cast<std::size_t>(best)]) >=
                                      model.params.decide_class;
  if (track.decided_class >= 0 && (!sure || best != track.decided_class)) {
    for (ClassId j = 0; j < model.classes.size(); ++j) {
      ClassFilter& f = track.bank[static_cast<std::size_t>(j)];
      if (j != track.decided_class) {
        f = converted(model.classes[track.decided_class],
                      track.bank[static_cast<std::size_t>(track.decided_class)], model.classes[j],
                      f.extent);
      }
    }
    track.decided_class = -1;
  } else if (sure) {
    track.decided_class = best;
  }
}

}  // namespace perception
