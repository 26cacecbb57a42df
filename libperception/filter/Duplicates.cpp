#include "libperception/filter/Duplicates.h"

#include <algorithm>
#include <cmath>

#include "libperception/core/Frames.h"

namespace perception {
namespace {

constexpr double kUnseen = 0.25;  // [s] a track not hit for so long gives way to a fresh one
constexpr double kSureClass =
    0.95;  // a track of unsure class has no footprint that others must respect
constexpr double kNeverLarger =
    8;  // [m] half length of the longest footprint: beyond it no test is needed

struct Footprint {
  Vector2 centre, half;  // [m]
  double yaw = 0;        // [rad]
  double area = 0;  // [m^2] of a track whose class is sure, else 0
  Stamp last_hit;
};

Footprint footprintOf(const Track& t) {
  const ClassFilter& f = t.bank[static_cast<std::size_t>(t.likeliestClass())];
  Footprint out;
  out.centre = f.x.head<2>();
  out.half = f.oriented ? Vector2(0.5 * f.extent.length, 0.5 * f.extent.width)
                        : Vector2::Constant(0.25 * (f.extent.length + f.extent.width));
  out.yaw = f.oriented ? f.x[3] : 0;
  const bool sure =
      std::exp(t.log_class[static_cast<std::size_t>(t.likeliestClass())]) >= kSureClass;
  out.area = sure ? 4 * out.half.x() * out.half.y() : 0;
  out.last_hit = *std::max_element(t.last_hit.begin(), t.last_hit.end());
  return out;
}

bool holds(const Footprint& f, const Vector2& p) {
  const Vector2 own = rotate2(-f.yaw, p - f.centre);
  return std::abs(own.x()) <= f.half.x() && std::abs(own.y()) <= f.half.y();
}

/// The younger one's state under the older one's identity.
TrackHandle takeOver(const Track& older, const Track& younger) {
  Track t = younger;
  t.id = older.id;
  t.birth = older.birth;
  t.log_class = older.log_class;
  for (std::size_t i = 0; i < t.hits.size(); ++i) t.hits[i] += older.hits[i];
  return std::make_shared<const Track>(std::move(t));
}

}  // namespace

void mergeDuplicates(const FilterModel& model, Stamp now, Hypothesis& hypothesis) {
  const double least = model.params.merge_area;
  if (least <= 0) return;
  auto& tracks = hypothesis.tracks;
  std::vector<Footprint> feet;
  feet.reserve(tracks.size());
  for (const auto& t : tracks) feet.push_back(footprintOf(*t));
  std::vector<char> gone(tracks.size(), 0);
  for (std::size_t i = 0; i < tracks.size(); ++i) {  // in order of id: i is older than j
    for (std::size_t j = i + 1; j < tracks.size() && !gone[i]; ++j) {
      if (gone[j] || (feet[i].centre - feet[j].centre).squaredNorm() > kNeverLarger * kNeverLarger)
        continue;
      const bool swallows = feet[i].area >= least && holds(feet[i], feet[j].centre);
      const bool swallowed = feet[j].area >= least && holds(feet[j], feet[i].centre);
      if (!swallows && !swallowed) continue;
      gone[j] = 1;
      if (now - feet[i].last_hit > kUnseen && feet[j].last_hit == now) {
        tracks[i] = takeOver(*tracks[i], *tracks[j]);
        feet[i] = feet[j];
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!gone[i]) tracks[kept++] = tracks[i];
  }
  tracks.resize(kept);
}

}  // namespace perception
