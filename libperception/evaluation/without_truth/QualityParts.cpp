#include "libperception/evaluation/without_truth/QualityParts.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libperception/core/Csv.h"
#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/matching/ScenePairs.h"

namespace perception {
namespace {

constexpr double kSmoothing = 0.5;      ///< [s] each side, of the curve through a track
constexpr std::size_t kFewest = 5;      ///< positions for such a curve
constexpr double kAhead = 1;            ///< [s] over which velocities are checked
constexpr double kAheadSlack = 0.06;    ///< [s]
constexpr double kShort = 1;            ///< [s] of a life
constexpr double kBorderMargin = 3;     ///< [m] and
constexpr double kBorderAngle = 0.175;  ///< [rad] where objects may come into view and leave it
constexpr double kHandoverTime = 1, kHandoverReach = 2;  ///< [s], [m]
constexpr double kSameInstant = 1e-6;                    ///< [s]
constexpr double kLately = 0.5;                          ///< [s] since a modality hit an object

using Kind = QualityMoment::Kind;

QualityMoment momentOf(Kind kind, std::uint64_t id, const QualitySample& sample) {
  return {kind, sample.t, id, sample.object->position.head<2>(), 0};
}

/// [m^2] squared distance of sample k from the parabola through its neighbors.
Figure offCurve(const std::vector<QualitySample>& track, std::size_t k) {
  std::size_t from = k, to = k;
  while (from > 0 && track[k].t - track[from - 1].t <= kSmoothing) --from;
  while (to + 1 < track.size() && track[to + 1].t - track[k].t <= kSmoothing) ++to;
  const std::size_t n = to - from + 1;
  if (n < kFewest || from == k || to == k) return {};
  Eigen::MatrixXd A(static_cast<Eigen::Index>(n), 3), b(static_cast<Eigen::Index>(n), 2);
  for (std::size_t i = from; i <= to; ++i) {
    const double dt = track[i].t - track[k].t;
    const auto row = static_cast<Eigen::Index>(i - from);
    A.row(row) << 1, dt, dt * dt;
    b.row(row) = track[i].object->position.head<2>();
  }
  const Eigen::MatrixXd fit = A.colPivHouseholderQr().solve(b);
  return (fit.row(0).transpose() - track[k].object->position.head<2>()).squaredNorm();
}

/// [m^2/s^2] squared difference of the mean velocity over kAhead and the one that was said.
Figure offVelocity(const std::vector<QualitySample>& track, std::size_t k) {
  for (std::size_t i = k + 1; i < track.size(); ++i) {
    const double dt = track[i].t - track[k].t;
    if (dt < kAhead - kAheadSlack) continue;
    if (dt > kAhead + kAheadSlack) return {};
    const SceneObject &a = *track[k].object, &b = *track[i].object;
    const Vector2 moved = (b.position - a.position).head<2>() / dt;
    return (moved - 0.5 * (a.velocity + b.velocity)).squaredNorm();
  }
  return {};
}

}  // namespace

QualitySector::QualitySector(const TrackedRun& run, const QualityOptions& options)
    : options_(options) {
  for (const std::string& name : run.class_names)
    named_.push_back(std::find(options.unnamed.begin(), options.unnamed.end(), name) ==
                     options.unnamed.end());
}

bool QualitySector::holds(const Scene& scene, const SceneObject& object,
                          bool away_from_border) const {
  const Vector3 p = scene.ego.T_world_ego.inverse() * object.position;
  const double border = away_from_border ? kBorderMargin : 0;
  const double half = options_.selection.fov / 2;
  const bool all_around = half >= kPi - 1e-9;
  return p.head<2>().norm() <= options_.selection.range - border &&
         (all_around ||
          std::abs(std::atan2(p.y(), p.x())) <= half - (away_from_border ? kBorderAngle : 0));
}

QualitySamples samplesOf(const TrackedRun& run, const QualitySector& sector) {
  QualitySamples tracks;
  for (const Scene& scene : run.scenes) {
    for (const SceneObject& object : scene.objects) {
      if (!sector.named(object) || !sector.holds(scene, object, false)) continue;
      QualitySample sample{scene.stamp - run.first_stamp, &object,
                           sector.holds(scene, object, true), 0};
      for (const auto& [modality, stamp] : object.last_hit)
        sample.modalities += scene.stamp - stamp <= kLately;
      tracks[object.id].push_back(sample);
    }
  }
  return tracks;
}

SampleFigures sampleFigures(const QualitySamples& tracks, bool several_modalities,
                            std::vector<QualityMoment>& moments) {
  SampleFigures f;
  if (several_modalities) f.alone = 0.0;
  for (const auto& [id, track] : tracks) {
    f.seconds += track.back().t - track.front().t;
    for (std::size_t k = 0; k < track.size(); ++k) {
      const SceneObject& o = *track[k].object;
      if (const auto d = offCurve(track, k)) f.curve.add(*d);
      if (const auto d = offVelocity(track, k)) f.velocity.add(*d);
      f.unsure.add(o.classified ? 0 : 1);
      f.doubt += 1 - o.existence;
      if (f.alone) *f.alone += track[k].modalities <= 1 ? 1 : 0;
      if (k > 0 && o.class_id != track[k - 1].object->class_id) {
        ++f.flips;
        moments.push_back(momentOf(Kind::kClassChange, id, track[k]));
      }
    }
  }
  return f;
}

TrackFigures trackFigures(const QualitySamples& tracks, double first, double last,
                          std::vector<QualityMoment>& moments) {
  TrackFigures f;
  for (const auto& [id, track] : tracks) {
    const QualitySample &begin = track.front(), &end = track.back();
    const bool begins_late = begin.t > first + kShort, ends_early = end.t < last - kShort;
    if (end.t - begin.t < kShort && begin.t > first && ends_early) {
      ++f.short_lives;
      moments.push_back(momentOf(Kind::kShortLife, id, begin));
    }
    if (begins_late) {
      ++f.ends;
      f.sudden += begin.inside;
    }
    if (ends_early) {
      ++f.ends;
      f.sudden += end.inside;
      if (end.inside) moments.push_back(momentOf(Kind::kLostInView, id, end));
    }
    if (!ends_early) continue;
    for (const auto& [other_id, other] : tracks) {
      const double dt = other.front().t - end.t;
      if (other_id == id || dt <= 0 || dt > kHandoverTime) continue;
      const Vector2 there = end.object->position.head<2>() + dt * end.object->velocity;
      if ((there - other.front().object->position.head<2>()).norm() > kHandoverReach) continue;
      ++f.handovers;
      moments.push_back(momentOf(Kind::kHandover, other_id, other.front()));
      moments.back().former = id;
      break;
    }
  }
  return f;
}

InnovationFigures innovationFigures(const TrackedRun& run, const QualityOptions& options) {
  const std::string file = run.dir + "/innovations.csv";
  if (!std::filesystem::exists(file)) return {};
  const CsvTable table = CsvTable::fromFile(file);
  const auto of = table.column("class"), axes = table.column("axes"), nis = table.column("nis"),
             pair_axes = table.column("pair_axes"), lag1 = table.column("lag1");
  double axes_sum = 0, squares = 0, pairs = 0, products = 0;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    const std::string name(table.text(r, of));
    if (std::find(options.unnamed.begin(), options.unnamed.end(), name) != options.unnamed.end())
      continue;
    axes_sum += table.real(r, axes), squares += table.real(r, axes) * table.real(r, nis);
    const double rho = table.realOrNan(r, lag1);
    if (!std::isnan(rho))
      pairs += table.real(r, pair_axes), products += table.real(r, pair_axes) * rho;
  }
  InnovationFigures figures;
  if (axes_sum > 0 && squares > 0) figures.off = std::abs(std::log2(squares / axes_sum));
  if (pairs > 0) figures.lag1 = std::abs(products / pairs);
  return figures;
}

void SeedFigures::add(const TrackedRun& run, const TrackedRun& sibling,
                      const QualitySector& sector) {
  for (const auto& [a, b] : commonInstants(run, sibling, kSameInstant)) {
    const Scene &scene = run.scenes[a], &other = sibling.scenes[b];
    const std::vector<int> pairs = matchObjects(scene, other, kHandoverReach);
    double unmatched = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const SceneObject& o = scene.objects[i];
      if (!sector.named(o) || !sector.holds(scene, o, false)) continue;
      unmatched += pairs[i] < 0;
      if (pairs[i] >= 0)
        distance.add((o.position - other.objects[static_cast<std::size_t>(pairs[i])].position)
                         .head<2>()
                         .squaredNorm());
    }
    alone.add(unmatched);
  }
}

}  // namespace perception
