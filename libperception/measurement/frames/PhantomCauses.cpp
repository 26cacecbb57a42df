#include "libperception/measurement/frames/PhantomCauses.h"

namespace perception {
namespace {

constexpr double kWake = 0.9;  // the least existence of a track that leaves a wake

}  // namespace

bool PhantomCauses::any() const {
  return weather > 0 || clouds != nullptr || (wakes != nullptr && !wakes->empty());
}

CausesHere PhantomCauses::at(const Vector2& place, Stamp now, bool likeliest_alone) const {
  CausesHere here = {weather, clouds != nullptr ? clouds->at(place) : 0};
  here.spray = spray;
  if (wakes == nullptr || (likeliest_alone && weather >= kWake)) return here;
  const WakeMap::Past past = wakes->pastOf(place, now);
  here.wake = past.has_left ? kWake : 0;
  here.came = past.has_left || past.came_by ? kWake : 0;
  return here;
}

}  // namespace perception
