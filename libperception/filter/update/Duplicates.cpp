#include "libperception/filter/update/Duplicates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libperception/core/Frames.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

constexpr double kUnseen = 0.25;  // [s] a track not hit for so long gives way to a fresh one
constexpr std::uint32_t kAbsent = static_cast<std::uint32_t>(-1);
constexpr double kThere = 0.5;  // existence of what is likelier there than not
/// A track whose class probability is below .95 has no footprint that others are merged into; two
/// that are likelier vehicles than not are merged all the same.
const double kLogSureClass = std::log(0.95), kLogLikelyClass = std::log(0.5);

/// Vehicles on one line keep more than this [s] between them from this speed [m/s] on. The shortest
/// headways in traffic are three times as long. Slower ones that surely drive are one vehicle where
/// their footprints overlap along the line by more than this [m], for errors of their lengths.
constexpr double kShortestHeadway = 0.1, kDriving = 8, kOverlap = 0.5;
/// [m/s] by which their speeds differ at most; [m] length of the longest vehicle with a trailer.
constexpr double kSameSpeed = 1.5, kLongestTrain = 20;
/// Deviations by which headings of one vehicle's parts differ at most, as newborns' err (assumed).
constexpr double kHeadingSigmas = 2;
/// Deviations by which a cyclist is at most longer than the mean.
constexpr double kCyclistSigmas = 4;

struct Footprint {
  std::uint64_t id = 0;
  Vector2 center, half;     // [m]
  double corner2 = 0;       // [m^2] square of the distance from the center to a corner
  double yaw = 0;           // [rad]
  double area = 0;          // [m^2]
  bool sure = false;        // of its class
  bool vehicle = false;     // more likely than not
  bool person = false;      // or a cyclist, more likely than not
  bool no_cyclist = false;  // called one, but too long
  Stamp last_hit;
  bool fresh = true;  // of this scan
  bool oriented = false;
  double speed = 0;         // [m/s] along yaw; 0 where it is not sure
  double yaw_variance = 0;  // [rad^2] where the speed is sure
};

/// For tracks with deferred prediction, the predicted position.
Footprint footprintOf(const Track& t, const FilterModel& model, Stamp now) {
  const ClassId best = t.likeliestClass();
  const ClassFilter& f = t.bank[static_cast<std::size_t>(best)];
  Footprint out;
  out.id = t.id;
  out.center = f.x.head<2>();
  out.fresh = t.stamp == now;
  if (!out.fresh)
    out.center += (now - t.stamp) * kinematicsOf(model.classes[best], f).q.segment<2>(2);
  out.half = f.oriented ? Vector2(0.5 * f.extent.length, 0.5 * f.extent.width)
                        : Vector2::Constant(0.25 * (f.extent.length + f.extent.width));
  out.corner2 = out.half.squaredNorm() + 1e-6;
  out.yaw = f.oriented ? f.x[3] : 0;
  out.oriented = f.oriented;
  if (f.oriented && f.x[2] * f.x[2] > 9 * f.P(2, 2))
    out.speed = f.x[2], out.yaw_variance = f.P(3, 3);
  const double log_class = t.log_class[static_cast<std::size_t>(best)];
  out.sure = log_class >= kLogSureClass;
  out.vehicle = log_class >= kLogLikelyClass && model.classes[best].motion->has_heading;
  const ObjectShape shape = model.classes[best].shape;
  out.person = log_class >= kLogLikelyClass &&
               (shape == ObjectShape::kPedestrian || shape == ObjectShape::kCyclist);
  out.no_cyclist = shape == ObjectShape::kCyclist &&
                   f.extent.length > model.classes[best].length +
                                         kCyclistSigmas * model.classes[best].length_sigma;
  out.area = 4 * out.half.x() * out.half.y();
  out.last_hit = *std::max_element(t.last_hit.begin(), t.last_hit.end());
  return out;
}

bool holds(const Footprint& f, const Vector2& p) {
  const Vector2 own = rotate2(-f.yaw, p - f.center);
  return std::abs(own.x()) <= f.half.x() && std::abs(own.y()) <= f.half.y();
}

/// Whether two footprints are the parts of one vehicle, or of one and its trailer: they drive on
/// one line, equally fast, so close behind each other that no two drivers would, or overlap.
bool isTrain(const Footprint& a, const Footprint& b) {
  const double slower = std::min(std::abs(a.speed), std::abs(b.speed));
  if (!a.vehicle || !b.vehicle || slower == 0) return false;
  const Vector2 apart = rotate2(-a.yaw, b.center - a.center);
  const Vector2 along(std::cos(a.yaw), std::sin(a.yaw)), other(std::cos(b.yaw), std::sin(b.yaw));
  const double length = 2 * (a.half.x() + b.half.x());
  const double gap = std::abs(apart.x()) - length / 2,
               most = slower >= kDriving ? kShortestHeadway * std::abs(a.speed) : -kOverlap;
  const Vector2 faster = rotate2(-a.yaw, a.speed * along - b.speed * other);
  const double sideways =
      kSameSpeed + kHeadingSigmas * slower * std::sqrt(a.yaw_variance + b.yaw_variance);
  return std::abs(apart.y()) < std::max(a.half.y(), b.half.y()) &&
         std::abs(faster.x()) < kSameSpeed && std::abs(faster.y()) < sideways && gap < most &&
         length + gap < kLongestTrain;
}

/// Whether the older of two tracks in one place is what a larger one, the younger, was taken for: a
/// fragment of it, or a cyclist who is as long as a vehicle.
bool isReplaced(const Footprint& older, const Footprint& younger, bool swallows, bool both) {
  if (!younger.oriented) return false;
  if (older.no_cyclist && younger.vehicle && younger.sure && !younger.no_cyclist) return true;
  return !swallows && !both && !older.person;
}

/// The younger track's state with the older track's id and class, with all that has been counted in
/// that; with its own class if the older one was a fragment of it.
TrackHandle takeOver(const Track& older, const Track& younger, bool fragment) {
  Track t = younger;
  t.id = older.id;
  t.birth = older.birth;
  if (!fragment) {
    t.log_class = older.log_class;
    t.evidence = older.evidence;
    t.length = older.length, t.width = older.width, t.height = older.height;
    t.fitting_length = older.fitting_length, t.fitting_width = older.fitting_width;
    t.longest = older.longest;
  }
  t.phantom = std::min(older.phantom, younger.phantom);
  t.previous = older.previous;
  for (std::size_t i = 0; i < t.hits.size(); ++i) t.hits[i] += older.hits[i];
  return std::make_shared<const Track>(std::move(t));
}

/// Detected once and likely not there: where a real object comes by, it is not that object.
bool isGhost(const Track& t) {
  return t.existence < kThere && std::accumulate(t.hits.begin(), t.hits.end(), 0) <= 1;
}

}  // namespace

DuplicateTable::DuplicateTable(const FilterModel& model, Stamp now, const TrackTable& tracks)
    : cells_(tracks.size()) {
  const double least = model.params.merge_area;
  if (least <= 0) return;
  std::vector<Footprint> feet(tracks.size());
  std::vector<std::size_t> there, large;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!tracks[i]) continue;
    feet[i] = footprintOf(*tracks[i], model, now);
    there.push_back(i);
    if (feet[i].area >= least && (feet[i].sure || feet[i].vehicle)) large.push_back(i);
  }
  const auto swallows = [&](std::size_t i) { return feet[i].area >= least && feet[i].sure; };
  for (const std::size_t i : large) {
    for (const std::size_t j : there) {
      if ((feet[j].center - feet[i].center).squaredNorm() > feet[i].corner2) continue;  // most
      if (!feet[i].fresh && !feet[j].fresh) continue;  // compared when one of them was
      if (feet[i].id == feet[j].id || !holds(feet[i], feet[j].center)) continue;
      const bool both = feet[j].area >= least && feet[i].vehicle && feet[j].vehicle;
      if (!swallows(i) && !both) continue;
      // One entry suffices for two large footprints that contain each other's centers.
      if ((swallows(j) || both) && j < i && holds(feet[j], feet[i].center)) continue;
      const bool first = feet[i].id < feet[j].id;
      const std::size_t older = first ? i : j, younger = first ? j : i;
      Conflict conflict{older, younger, nullptr};
      const bool fragment = isReplaced(feet[older], feet[younger], swallows(older), both);
      const bool stale = now - feet[older].last_hit > kUnseen && feet[younger].last_hit == now;
      if (stale && isGhost(*tracks[older]) && tracks[younger]->existence >= kThere)
        conflict = {younger, older, nullptr};
      else if (stale && feet[older].person && feet[younger].vehicle)
        continue;  // hidden behind it, not what it is
      else if ((fragment || stale) &&
               tracks[younger]->phantom <= std::max(0.5, tracks[older]->phantom))
        conflict.replacement = takeOver(*tracks[older], *tracks[younger], fragment);
      conflicts_.push_back(std::move(conflict));
    }
  }
  for (const std::size_t i : large) {
    for (const std::size_t j : large) {
      if (feet[j].area < least || feet[i].area < least || feet[i].id >= feet[j].id) continue;
      if (feet[i].fresh && feet[j].fresh && isTrain(feet[i], feet[j]))
        conflicts_.push_back({i, j, nullptr});
    }
  }
  std::sort(conflicts_.begin(), conflicts_.end(), [&](const Conflict& a, const Conflict& b) {
    const auto ia = tracks[a.kept]->id, ib = tracks[b.kept]->id;
    if (ia != ib) return ia < ib;
    const auto ja = tracks[a.dropped]->id, jb = tracks[b.dropped]->id;
    if (ja != jb) return ja < jb;
    return a.kept != b.kept ? a.kept < b.kept : a.dropped < b.dropped;
  });
  if (conflicts_.empty()) return;
  involved_.assign(cells_, kAbsent);
  for (const Conflict& c : conflicts_) {
    for (const std::size_t cell : {c.kept, c.dropped}) {
      std::uint32_t& number = involved_[cell];
      if (number == kAbsent) number = static_cast<std::uint32_t>(involved_count_++);
    }
  }
}

std::vector<std::uint32_t> DuplicateTable::merged(std::vector<std::uint32_t> cells) const {
  if (conflicts_.empty()) return cells;
  std::vector<std::uint32_t> place(involved_count_, kAbsent);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::uint32_t number = involved_[cells[i]];
    if (number != kAbsent) place[number] = static_cast<std::uint32_t>(i);
  }
  for (std::size_t c = 0; c < conflicts_.size(); ++c) {
    const Conflict& conflict = conflicts_[c];
    std::uint32_t& dropped = place[involved_[conflict.dropped]];
    const std::uint32_t kept = place[involved_[conflict.kept]];
    if (kept == kAbsent || dropped == kAbsent) continue;
    cells[dropped] = kAbsent;
    dropped = kAbsent;
    if (conflict.replacement) cells[kept] = static_cast<std::uint32_t>(cells_ + c);
  }
  cells.erase(std::remove(cells.begin(), cells.end(), kAbsent), cells.end());
  return cells;
}

void DuplicateTable::appendReplacements(TrackTable& tracks) const {
  for (const Conflict& c : conflicts_) tracks.push_back(c.replacement);
}

}  // namespace perception
