#include "libperception/evaluation/without_truth/Quality.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/evaluation/without_truth/QualityParts.h"

namespace perception {
namespace {

Figure shareOf(std::size_t part, std::size_t whole) {
  return whole > 0 ? Figure(static_cast<double>(part) / static_cast<double>(whole)) : Figure();
}

/// Ranks from 0, equal values share their mean.
std::vector<double> ranksOf(const std::vector<double>& values) {
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (const double v : values) ranks[i] += v < values[i] ? 1 : v == values[i] ? 0.5 : 0;
  }
  return ranks;
}

constexpr double kFollows = 0.6;  ///< rank correlation

}  // namespace

bool QualityKind::follows_it() const { return std::max(between_logs, within_log) >= kFollows; }

const char* nameOf(TrueError error) {
  switch (error) {
    case TrueError::kMissed:
      return "missed share";
    case TrueError::kFalse:
      return "false objects an instant";
    case TrueError::kPosition:
      return "position, rms [m]";
    case TrueError::kVelocity:
      return "velocity, rms [m/s]";
    case TrueError::kClass:
      return "not of the right class, share";
    case TrueError::kSwitches:
      return "id switches a view";
    case TrueError::kOverall:
      break;
  }
  return "1 - MOTA";
}

const std::vector<QualityKind>& qualityKinds() {
  static const std::vector<QualityKind> kinds = {
      {"nis", "-", "innovations against their covariances: |log2 of NIS per axis|",
       TrueError::kPosition, 0.07, -0.22},
      {"lag1", "-", "innovations repeat: autocorrelation at the next update of a track",
       TrueError::kPosition, 0.44, 0.17},
      {"off_curve", "m", "positions off the smooth curve through half a second before and after",
       TrueError::kPosition, 0.27, 0.34},
      {"off_velocity", "m/s", "motion over a second against the velocity that was said",
       TrueError::kVelocity, 0.75, 0.56},
      {"short", "an instant", "tracks of less than a second", TrueError::kFalse, 0.62, 0.62},
      {"sudden", "share", "beginnings and ends of tracks in full view", TrueError::kSwitches, 0.48,
       0.30},
      {"handovers", "a minute",
       "tracks that begin where another has just ended, per minute of an object",
       TrueError::kSwitches, 0.37, 0.28},
      {"unsure", "share", "outputs without a sure class", TrueError::kClass, 0.30, 0.57},
      {"flips", "a minute", "changes of the most probable class, per minute of an object",
       TrueError::kClass, 0.12, 0.30},
      {"doubt", "an instant", "sum of the probabilities that outputs are no objects",
       TrueError::kFalse, 0.60, 0.62},
      {"alone", "an instant", "outputs that one kind of sensor alone has hit within half a second",
       TrueError::kFalse, 0.69, 0.89},
      {"seeds_alone", "an instant", "outputs that a run with another seed does not have",
       TrueError::kFalse, 0.39, 0.80},
      {"seeds_apart", "m", "positions apart from those of a run with another seed, rms",
       TrueError::kPosition, 0.74, 0.28}};
  return kinds;
}

std::string QualityMoment::text() const {
  switch (kind) {
    case Kind::kClassChange:
      return "its class changes";
    case Kind::kShortLife:
      return "is there for less than a second";
    case Kind::kLostInView:
      return "vanishes in view";
    case Kind::kHandover:
      return fmt::format("continues {}", former);
  }
  return "";
}

Quality qualityOf(const TrackedRun& run, const std::vector<const TrackedRun*>& siblings,
                  const QualityOptions& options) {
  Quality quality;
  const QualitySector sector(run, options);
  const QualitySamples tracks = samplesOf(run, sector);
  std::set<Modality> modalities;
  for (const Scene& scene : run.scenes)
    for (const SceneObject& o : scene.objects)
      for (const auto& hit : o.last_hit) modalities.insert(hit.first);
  const SampleFigures s = sampleFigures(tracks, modalities.size() > 1, quality.moments);
  const double first = run.scenes.empty() ? 0 : run.scenes.front().stamp - run.first_stamp;
  const double last = run.scenes.empty() ? 0 : run.scenes.back().stamp - run.first_stamp;
  const TrackFigures t = trackFigures(tracks, first, last, quality.moments);
  const InnovationFigures innovations = innovationFigures(run, options);
  quality.objects = tracks.size();
  quality.minutes = s.seconds / 60;
  const auto perMinute = [&](std::size_t count) {
    return quality.minutes > 0 ? Figure(static_cast<double>(count) / quality.minutes) : Figure();
  };
  const auto perInstant = [&](double sum) {
    return run.scenes.empty() ? Figure() : Figure(sum / static_cast<double>(run.scenes.size()));
  };
  SeedFigures seeds;
  for (const TrackedRun* sibling : siblings) seeds.add(run, *sibling, sector);
  quality.values = {innovations.off,
                    innovations.lag1,
                    s.curve.root(),
                    s.velocity.root(),
                    perInstant(static_cast<double>(t.short_lives)),
                    shareOf(t.sudden, t.ends),
                    perMinute(t.handovers),
                    s.unsure.value(),
                    perMinute(s.flips),
                    perInstant(s.doubt),
                    s.alone ? perInstant(*s.alone) : Figure(),
                    seeds.alone.value(),
                    seeds.distance.root()};
  std::stable_sort(quality.moments.begin(), quality.moments.end(),
                   [](const auto& a, const auto& b) { return a.t < b.t; });
  return quality;
}

std::array<Figure, kTrueErrors> trueErrors(const Evaluation& evaluation) {
  const TrackingFigures f = trackingFigures(evaluation, Pairing::kOneToOne);
  const ClearFigures clear = clearFigures(evaluation);
  const auto complement = [](const Figure& x) { return x ? Figure(1 - *x) : Figure(); };
  return {complement(f.tracked_a), shareOf(clear.false_objects, evaluation.instants.size()),
          f.position_rms,          f.velocity_rms,
          complement(f.correct),   shareOf(f.id_switches, f.active),
          complement(clear.mota)};
}

Figure rankCorrelation(const std::vector<Figure>& a, const std::vector<Figure>& b) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    if (!a[i] || !b[i]) continue;
    x.push_back(*a[i]), y.push_back(*b[i]);
  }
  if (x.size() < 3) return {};
  const std::vector<double> p = ranksOf(x), q = ranksOf(y);
  const double mean = 0.5 * static_cast<double>(x.size());
  double pp = 0, qq = 0, pq = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    pp += (p[i] - mean) * (p[i] - mean), qq += (q[i] - mean) * (q[i] - mean);
    pq += (p[i] - mean) * (q[i] - mean);
  }
  return pp > 0 && qq > 0 ? Figure(pq / std::sqrt(pp * qq)) : Figure();
}

}  // namespace perception
