#include "libperception/filter/update/LanePrior.h"

#include <cmath>

#include "libperception/core/math/Angle.h"
#include "libperception/core/math/LogMath.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {

void LaneParams::visit(ParamVisitor& v) {
  v.path("file", file, "FILE.lanes.csv in the log's world frame; empty: no prior");
  v.expert();
  v.angle("sigma_deg", sigma, {0.5, 90}, "spread of headings about the lane's direction");
  v.real("forward", forward, {0.5, 0.999}, "",
         "share that faces the driving direction; .5: axis only");
  v.real("interval", interval, {0.01, 1e6}, "s",
         "shortest time between two lane updates of an object");
}

void LanePrior::apply(const FilterModel& model, Track& track) const {
  if (track.stamp - track.last_lane < params_.interval) return;
  double wheeled = 0;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    if (model.classes[j].motion->has_heading)
      wheeled += std::exp(track.log_class[static_cast<std::size_t>(j)]);
  }
  if (wheeled < 0.5) return;  // who crosses on foot is not to become a cyclist along the lane
  bool spoke = false;
  for (ClassId j = 0; j < model.classes.size(); ++j) {
    if (model.classes[j].motion->has_heading && track.live(j))
      spoke = apply(model, track.bank[static_cast<std::size_t>(j)]) || spoke;
  }
  if (spoke) track.last_lane = track.stamp;
}

bool LanePrior::apply(const FilterModel& model, ClassFilter& f) const {
  const auto places = map_.at(f.x.head<2>());
  if (places.empty()) return false;
  const double variance = params_.sigma * params_.sigma;
  if (!f.oriented) {
    // Moving objects are oriented by their velocity; crossing lanes are ambiguous.
    if (f.x.tail<2>().norm() >= model.params.orient_min_speed) return false;
    for (const auto& p : places) {
      if (std::abs(wrapAxis(p.direction - places[0].direction)) > params_.sigma) return false;
    }
    places[0].one_way ? orientAlong(places[0].direction, variance, f)
                      : orientByAxis(places[0].direction, variance, f);
  }
  const LanePlace* nearest = &places[0];  // in direction
  const auto off = [&](const LanePlace& p) { return wrapAxis(p.direction - f.x[3]); };
  for (const auto& p : places) {
    if (std::abs(off(p)) < std::abs(off(*nearest))) nearest = &p;
  }
  const double y = off(*nearest);
  if (y * y >= kYawGate * (f.P(3, 3) + variance)) return false;  // it turns, crosses or leaves
  updateYaw(y, variance, f);
  if (model.params.heading != HeadingMode::kSplit) return true;
  const double evidence = nearest->one_way ? logit(params_.forward) : 0;
  const bool same = std::abs(wrapAngle(nearest->direction - f.x[3])) <= kPi / 2;
  const double lane = same ? evidence : -evidence;
  f.heading.log_odds += lane - f.heading.lane;
  f.heading.lane = lane;
  if (asksForReversal(f.heading, f.x[2], f.P(2, 2), model.params.heading)) reverse(f);
  return true;
}

}  // namespace perception
