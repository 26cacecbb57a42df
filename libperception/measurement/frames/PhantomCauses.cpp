#include "libperception/measurement/frames/PhantomCauses.h"

namespace perception {
namespace {

constexpr double kWake = 0.9;  // the least existence of a track that leaves a wake

}  // namespace

bool PhantomCauses::any() const {
  return weather > 0 || clouds != nullptr || (wakes != nullptr && !wakes->empty());
}

CausesHere PhantomCauses::at(const Vector2& place, Stamp now) const {
  CausesHere here = {weather, clouds != nullptr ? clouds->at(place) : 0};
  if (wakes == nullptr) return here;
  here.wake = wakes->hasLeft(place, now) ? kWake : 0;
  here.came = here.wake > 0 || wakes->cameBy(place, now) ? kWake : 0;
  return here;
}

}  // namespace perception
