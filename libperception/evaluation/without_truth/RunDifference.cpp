#include "libperception/evaluation/without_truth/RunDifference.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include "libperception/evaluation/matching/ScenePairs.h"
#include "libperception/evaluation/metrics/Identities.h"

namespace perception {
namespace {

/// What the other run has at the instant of a scene.
struct Opposite {
  const Scene* scene = nullptr;  ///< null: no scene
  std::vector<int> object;       ///< of it, by object of the own scene; -1: none in reach
};

/// A run with what the other one has at each of its scenes.
struct Side {
  const TrackedRun* run = nullptr;
  std::vector<std::size_t> merged;  ///< place among the classes of both runs, by ClassId
  std::vector<Opposite> opposite;   ///< by scene
  double period = 0.1;              ///< [s] between instants

  Side(const TrackedRun& tracked, std::vector<std::string>& classes)
      : run(&tracked), opposite(tracked.scenes.size()) {
    for (const std::string& name : tracked.class_names) {
      const auto found = std::find(classes.begin(), classes.end(), name);
      merged.push_back(static_cast<std::size_t>(found - classes.begin()));
      if (found == classes.end()) classes.push_back(name);
    }
  }
  std::size_t classOf(const SceneObject& o) const {
    return merged[static_cast<std::size_t>(o.class_id)];
  }
  std::vector<double> probabilities(const SceneObject& o, std::size_t classes) const {
    std::vector<double> p(classes, 0);
    for (std::size_t c = 0; c < o.class_probability.size(); ++c)
      p[merged[c]] = o.class_probability[c];
    return p;
  }
};

void setOpposites(Side& a, Side& b, const DifferenceOptions& options, RunDifference& difference) {
  const auto instants = commonInstants(*a.run, *b.run, options.same_instant);
  for (const auto& [i, j] : instants) {
    const Scene &in_a = a.run->scenes[i], &in_b = b.run->scenes[j];
    a.opposite[i] = {&in_b, matchObjects(in_a, in_b, options.reach)};
    b.opposite[j] = {&in_a, std::vector<int>(in_b.objects.size(), -1)};
    for (std::size_t o = 0; o < in_a.objects.size(); ++o) {
      const int c = a.opposite[i].object[o];
      if (c >= 0) b.opposite[j].object[static_cast<std::size_t>(c)] = static_cast<int>(o);
    }
    if (in_a.stamp != in_b.stamp) ++difference.shifted;
    const EgoState &ego_a = in_a.ego, &ego_b = in_b.ego;
    if (ego_a.T_world_ego.matrix() != ego_b.T_world_ego.matrix() ||
        ego_a.velocity != ego_b.velocity || ego_a.yaw_rate != ego_b.yaw_rate)
      ++difference.ego_apart;
    const auto path = [](const FreePath& p) {
      return std::tuple(p.distance, p.seen, p.blocked, p.stop, p.blocked && p.owner > 0);
    };
    if (in_a.path.has_value() != in_b.path.has_value() ||
        (in_a.path && path(*in_a.path) != path(*in_b.path)))
      ++difference.path_apart;
  }
  difference.common = instants.size();
  difference.only_a = a.run->scenes.size() - instants.size();
  difference.only_b = b.run->scenes.size() - instants.size();
  if (instants.size() < 2) return;
  a.period = b.period =
      (a.run->scenes[instants.back().first].stamp - a.run->scenes[instants.front().first].stamp) /
      static_cast<double>(instants.size() - 1);
}

using Other = ComparedIdentity::Other;

/// All identities of a run, as its scenes show them one after the other.
class RunCensus {
 public:
  RunCensus(const Side& side, Stamp start, std::size_t classes)
      : side_(side), start_(start), classes_(classes) {
    const auto& opposite = side.opposite;
    const auto common = [](const Opposite& o) { return o.scene != nullptr; };
    first_ = static_cast<std::size_t>(std::find_if(opposite.begin(), opposite.end(), common) -
                                      opposite.begin());
    end_ = static_cast<std::size_t>(opposite.rend() -
                                    std::find_if(opposite.rbegin(), opposite.rend(), common));
    for (std::size_t i = 0; i < opposite.size(); ++i) add(i);
  }
  std::map<std::uint64_t, ComparedIdentity> identities;

 private:
  void add(std::size_t i) {
    const Scene& scene = side_.run->scenes[i];
    const Opposite& opposite = side_.opposite[i];
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const SceneObject& o = scene.objects[k];
      ComparedIdentity& identity = identities[o.id];
      addObject(identity, o, scene.stamp - start_);
      Other other = Other::kNoInstant;
      if (opposite.scene) {
        ++identity.compared;
        const int c = opposite.object[k];
        other = c >= 0 ? Other::kMatched : Other::kNone;
        if (c >= 0) addMatch(identity, opposite.scene->objects[static_cast<std::size_t>(c)].id);
      } else if (i >= first_ && i < end_) {
        continue;  // between common instants
      }
      addStretch(identity, scene.stamp - start_, other);
    }
  }
  void addObject(ComparedIdentity& identity, const SceneObject& o, double t) const {
    if (identity.instants == 0) {
      identity.id = o.id;
      identity.first = t;
      identity.class_instants.assign(classes_, 0);
    }
    identity.last = t;
    ++identity.instants;
    identity.last_class = side_.classOf(o);
    ++identity.class_instants[identity.last_class];
    const auto c = static_cast<std::size_t>(o.class_id);
    identity.last_probability = c < o.class_probability.size() ? o.class_probability[c] : 0;
  }
  void addMatch(ComparedIdentity& identity, std::uint64_t other) {
    ++identity.matched[other];
    const auto [last, fresh] = last_match_.emplace(identity.id, other);
    if (!fresh && last->second != other) ++identity.switches;
    last->second = other;
  }
  void addStretch(ComparedIdentity& identity, double t, Other other) const {
    auto& stretches = identity.stretches;
    const bool goes_on =
        !stretches.empty() && stretches.back().class_index == identity.last_class &&
        stretches.back().other == other && t - stretches.back().to < 2.5 * side_.period;
    if (!goes_on) stretches.push_back({t, t, identity.last_class, other});
    stretches.back().to = t + side_.period;
  }

  const Side& side_;
  Stamp start_;
  std::size_t classes_;
  std::size_t first_ = 0, end_ = 0;  // scenes from the first common instant to the last
  std::map<std::uint64_t, std::uint64_t> last_match_;
};

/// Whether two objects are alike in all but id and class probabilities.
bool sameState(const SceneObject& a, const SceneObject& b) {
  const auto state = [](const SceneObject& o) {
    return std::tuple(o.classified, o.existence, o.yaw, o.has_yaw, o.p_front, o.speed, o.length,
                      o.width, o.height, o.sd_x, o.sd_y, o.sd_yaw, o.sd_speed);
  };
  return a.position == b.position && a.velocity == b.velocity && state(a) == state(b) &&
         a.last_hit == b.last_hit;
}

/// Rows of pairs and of identities alone.
std::vector<IdentityDifference> pairedRows(const RunCensus& a, const RunCensus& b,
                                           std::size_t& pairs) {
  std::map<std::uint64_t, std::size_t> number_b;
  for (const auto& [id, identity] : b.identities) number_b.emplace(id, number_b.size());
  std::map<std::pair<std::size_t, std::size_t>, double> together;
  std::vector<IdentityDifference> rows;
  for (const auto& [id, identity] : a.identities) {
    for (const auto& [other, instants] : identity.matched)
      together[{rows.size(), number_b.at(other)}] = static_cast<double>(instants);
    rows.emplace_back().a = identity;
  }
  const auto column = pairIdentities(together, rows.size(), number_b.size());
  std::vector<std::size_t> row_of(number_b.size(), rows.size());
  for (std::size_t r = 0; r < column.size(); ++r)
    if (column[r] >= 0) row_of[static_cast<std::size_t>(column[r])] = r;
  for (const auto& [id, identity] : b.identities) {
    const std::size_t r = row_of[number_b.at(id)];
    if (r < column.size()) ++pairs;
    (r < column.size() ? rows[r] : rows.emplace_back()).b = identity;
  }
  return rows;
}

/// Adds up over the instants of A what a pair has in common.
void comparePairs(const Side& a, const Side& b, std::size_t classes,
                  std::vector<IdentityDifference>& rows) {
  std::map<std::uint64_t, IdentityDifference*> row_of;
  for (IdentityDifference& row : rows)
    if (row.a && row.b) row_of[row.a->id] = &row;
  std::map<std::uint64_t, std::size_t> both;  // instants with both, matched or not
  for (std::size_t i = 0; i < a.opposite.size(); ++i) {
    const Scene& scene = a.run->scenes[i];
    const Scene* other = a.opposite[i].scene;
    if (!other) continue;
    std::set<std::uint64_t> there;
    for (const SceneObject& o : other->objects) there.insert(o.id);
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const SceneObject& o = scene.objects[k];
      const auto found = row_of.find(o.id);
      if (found == row_of.end()) continue;
      IdentityDifference& row = *found->second;
      both[o.id] += there.count(row.b->id);
      const int c = a.opposite[i].object[k];
      if (c < 0) continue;
      const SceneObject& p = other->objects[static_cast<std::size_t>(c)];
      if (p.id != row.b->id) continue;
      ++row.together;
      row.distance_rms += std::pow(distanceOf(o, p, scene.stamp - other->stamp), 2);
      if (a.classOf(o) != b.classOf(p)) ++row.classes_apart;
      if (!sameState(o, p) || a.probabilities(o, classes) != b.probabilities(p, classes))
        ++row.values_apart;
    }
  }
  for (const auto& [id, row] : row_of) {
    row->distance_rms = std::sqrt(row->distance_rms / static_cast<double>(row->together));
    row->apart =
        row->a->compared + row->b->compared - both[id] - row->together + row->classes_apart;
  }
}

RunFigures figuresOf(const TrackedRun& run, std::size_t identities) {
  RunFigures figures;
  figures.scenes = run.scenes.size();
  figures.identities = identities;
  for (const Scene& scene : run.scenes) {
    figures.objects += scene.objects.size();
    for (const SceneObject& o : scene.objects) figures.sure += o.classified ? 1 : 0;
  }
  return figures;
}

}  // namespace

double RunFigures::objectsPerInstant() const {
  return scenes > 0 ? static_cast<double>(objects) / static_cast<double>(scenes) : 0;
}

bool RunDifference::none() const {
  return rows.empty() && shifted + only_a + only_b + ego_apart + path_apart == 0;
}

RunDifference compareRuns(const TrackedRun& a, const TrackedRun& b,
                          const DifferenceOptions& options) {
  RunDifference result;
  Side side_a(a, result.classes), side_b(b, result.classes);
  setOpposites(side_a, side_b, options, result);
  const RunCensus census_a(side_a, a.first_stamp, result.classes.size());
  const RunCensus census_b(side_b, a.first_stamp, result.classes.size());
  result.a = figuresOf(a, census_a.identities.size());
  result.b = figuresOf(b, census_b.identities.size());
  for (const TrackedRun* run : {&a, &b}) {
    if (!run->scenes.empty())
      result.end = std::max(result.end, run->scenes.back().stamp - a.first_stamp);
  }
  auto rows = pairedRows(census_a, census_b, result.pairs);
  comparePairs(side_a, side_b, result.classes.size(), rows);
  for (IdentityDifference& row : rows) {
    if (!row.a || !row.b) row.apart = (row.a ? *row.a : *row.b).instants;
    if (row.apart > 0 || row.values_apart > 0) result.rows.push_back(std::move(row));
  }
  std::stable_sort(result.rows.begin(), result.rows.end(), [](const auto& x, const auto& y) {
    return x.apart != y.apart ? x.apart > y.apart : x.distance_rms > y.distance_rms;
  });
  return result;
}

}  // namespace perception
