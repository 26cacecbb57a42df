#include "libperception/measurement/PhantomCauses.h"

namespace perception {
namespace {

constexpr double kWake = 0.9;        // the least existence of a track that leaves a wake
constexpr double kNegligible = 0.02;  // a doubt of so little changes no decision (assumed)

}  // namespace

bool PhantomCauses::any() const {
  return weather > kNegligible || (wakes != nullptr && !wakes->empty());
}

CausesHere PhantomCauses::at(const Vector2& place, Stamp now) const {
  const bool left = wakes != nullptr && wakes->hasLeft(place, now);
  return {weather > kNegligible ? weather : 0, left ? kWake : 0};
}

}  // namespace perception
