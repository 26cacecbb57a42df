#include "libperception/evaluation/metrics/Metrics.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

Figure ratio(std::size_t part, std::size_t whole) {
  if (whole == 0) return {};
  return static_cast<double>(part) / static_cast<double>(whole);
}

// A sum over instants as mean or rms; empty if nothing was added.
class Sum {
 public:
  void add(double value) {
    sum_ += value;
    squares_ += value * value;
    ++count_;
  }
  void add(const Figure& value) {
    if (value) add(*value);
  }
  Figure mean() const { return count_ ? Figure(sum_ / static_cast<double>(count_)) : Figure(); }
  Figure rms() const {
    return count_ ? Figure(std::sqrt(squares_ / static_cast<double>(count_))) : Figure();
  }

 private:
  double sum_ = 0, squares_ = 0;
  std::size_t count_ = 0;
};

bool isOf(const TruthSample& sample, ClassId class_id) {
  return class_id < 0 || sample.class_id == class_id;
}

// Follows one truth object through its active instants.
class TimelineBuilder {
 public:
  explicit TimelineBuilder(const TruthSample& first) {
    line_.id = first.id;
    line_.type = first.type;
    line_.class_id = first.class_id;
    line_.first_active = first.t;
  }

  void add(const TruthSample& sample, const std::optional<Match>& match) {
    line_.last_active = sample.t;
    ++line_.active;
    if (!match) {
      if (line_.returns > 0) ++untracked_since_;
      return;
    }
    if (line_.returns == 0) line_.first_tracked = sample.t;
    if (line_.returns > 0 && untracked_since_ > 0) ++line_.fragmentations;
    if (line_.returns > 0 && match->id != last_id_) ++line_.id_switches;
    line_.first_to_last += 1 + untracked_since_;
    untracked_since_ = 0;
    last_id_ = match->id;
    ++line_.returns;
    if (std::find(line_.ids.begin(), line_.ids.end(), match->id) == line_.ids.end()) {
      line_.ids.push_back(match->id);
    }
  }

  ObjectTimeline finish() {
    line_.tracked = ratio(line_.returns, line_.active);
    if (line_.first_tracked) line_.time_to_first_track = *line_.first_tracked - line_.first_active;
    return std::move(line_);
  }

 private:
  ObjectTimeline line_;
  std::size_t untracked_since_ = 0;
  std::uint64_t last_id_ = 0;
};

void addErrors(const Evaluation& evaluation, Pairing pairing, ClassId class_id,
               TrackingFigures& figures) {
  Sum range, center_range, bearing, position, speed, velocity, heading, reversed, sure,
      sure_reversed;
  for (const TruthSample& sample : evaluation.samples) {
    const auto& match = sample.matched(pairing);
    if (!isOf(sample, class_id) || !match) continue;
    range.add(match->view.closest_range - sample.view.closest_range);
    center_range.add(match->view.range - sample.view.range);
    bearing.add(wrapAngle(match->view.bearing - sample.view.bearing));
    position.add(match->distance);
    speed.add(match->speed_error);
    velocity.add(match->velocity_error);
    heading.add(match->heading_error);
    if (!match->heading_error) continue;
    const double opposite = std::abs(*match->heading_error) > kPi / 2 ? 1.0 : 0.0;
    const bool known = match->front_probability >= kSureFront;
    reversed.add(opposite);
    sure.add(known ? 1.0 : 0.0);
    if (known) sure_reversed.add(opposite);
  }
  figures.range_rms = range.rms();
  figures.center_range_rms = center_range.rms();
  figures.bearing_rms = bearing.rms();
  figures.position_rms = position.rms();
  figures.speed_rms = speed.rms();
  figures.velocity_rms = velocity.rms();
  figures.heading_rms = heading.rms();
  figures.heading_reversed = reversed.mean();
  figures.heading_sure = sure.mean();
  figures.heading_sure_reversed = sure_reversed.mean();
}

}  // namespace

TrackingFigures trackingFigures(const Evaluation& evaluation, Pairing pairing, ClassId class_id) {
  TrackingFigures figures;
  std::size_t correct = 0, mis = 0;
  for (const TruthSample& sample : evaluation.samples) {
    if (!isOf(sample, class_id)) continue;
    const auto& match = sample.matched(pairing);
    ++figures.active;
    if (sample.in_sensor_range) ++figures.in_sensor_range;
    if (!match) continue;
    ++figures.returns;
    if (sample.in_sensor_range) ++figures.returns_in_sensor_range;
    if (match->classified) ++(match->class_id == sample.class_id ? correct : mis);
  }
  std::size_t returns_of_known = 0;
  for (const ObjectTimeline& line : objectTimelines(evaluation, pairing)) {
    if (class_id >= 0 && line.class_id != class_id) continue;
    returns_of_known += line.returns;
    figures.first_to_last += line.first_to_last;
    figures.id_switches += line.id_switches;
    figures.fragmentations += line.fragmentations;
  }
  figures.tracked_a = ratio(figures.returns, figures.active);
  figures.tracked_b = ratio(figures.returns_in_sensor_range, figures.in_sensor_range);
  figures.tracked_c = ratio(returns_of_known, figures.first_to_last);
  figures.correct = ratio(correct, figures.returns);
  figures.mis = ratio(mis, figures.returns);
  figures.unclassified = ratio(figures.returns - correct - mis, figures.returns);
  addErrors(evaluation, pairing, class_id, figures);
  return figures;
}

std::vector<ObjectTimeline> objectTimelines(const Evaluation& evaluation, Pairing pairing) {
  std::map<std::int64_t, TimelineBuilder> builders;
  for (const TruthSample& sample : evaluation.samples) {
    if (sample.id < 0) continue;  // truth without ids: no object timelines
    builders.try_emplace(sample.id, sample).first->second.add(sample, sample.matched(pairing));
  }
  std::vector<ObjectTimeline> lines;
  for (auto& builder : builders) lines.push_back(builder.second.finish());
  std::stable_sort(lines.begin(), lines.end(),
                   [](const ObjectTimeline& a, const ObjectTimeline& b) {
                     return a.first_active < b.first_active;
                   });
  return lines;
}

Confusion confusion(const Evaluation& evaluation, Pairing pairing) {
  Confusion result;
  for (const TruthSample& sample : evaluation.samples) {
    Confusion::Row& row = result.by_type[sample.type];
    row.classified.resize(evaluation.class_names.size());
    const auto& match = sample.matched(pairing);
    if (!match) {
      ++row.missed;
    } else if (match->classified) {
      ++row.classified[static_cast<std::size_t>(match->class_id)];
    } else {
      ++row.unclassified;
    }
  }
  return result;
}

FalseObjectFigures falseObjectFigures(const Evaluation& evaluation, ClassId class_id) {
  FalseObjectFigures figures;
  figures.instants = evaluation.instants.size();
  for (const InstantFigures& instant : evaluation.instants) {
    figures.counts +=
        class_id < 0 ? instant.allOutputs() : instant.outputs[static_cast<std::size_t>(class_id)];
  }
  figures.per_instant = ratio(figures.counts.false_, figures.instants);
  figures.share = ratio(figures.counts.false_, figures.counts.named);
  figures.classified_per_instant = ratio(figures.counts.classified_false, figures.instants);
  figures.classified_share =
      ratio(figures.counts.classified_false, figures.counts.classified_named);
  return figures;
}

SetFigures setFigures(const Evaluation& evaluation, double cutoff) {
  SetFigures figures;
  Sum value, localization, missed, false_, ospa;
  double squares = 0;
  std::size_t pairs = 0;
  for (const InstantFigures& instant : evaluation.instants) {
    if (instant.truth == 0 && instant.estimates == 0) continue;  // neither truth nor estimate
    ++figures.instants;
    value.add(instant.gospa.value());
    localization.add(instant.gospa.localization);
    missed.add(instant.gospa.missed);
    false_.add(instant.gospa.false_);
    ospa.add(instant.ospa);
    squares += instant.gospa.localization;
    pairs += instant.gospa.pairs;
  }
  figures.gospa_mean = value.mean();
  figures.gospa_rms = value.rms();
  figures.localization = localization.mean();
  figures.missed = missed.mean();
  figures.false_ = false_.mean();
  const double one_object = cutoff * cutoff / 2;
  if (figures.missed) figures.missed_objects = *figures.missed / one_object;
  if (figures.false_) figures.false_objects = *figures.false_ / one_object;
  if (pairs > 0) figures.localization_rms = std::sqrt(squares / static_cast<double>(pairs));
  figures.ospa_mean = ospa.mean();
  return figures;
}

void ClearFigures::setMota() {
  const auto share = ratio(misses + false_objects + id_switches, truth);
  mota = share ? Figure(1 - *share) : Figure();
}

ClearFigures clearFigures(const Evaluation& evaluation) {
  ClearFigures figures;
  const TrackingFigures tracking = trackingFigures(evaluation, Pairing::kOneToOne);
  figures.truth = tracking.active;
  figures.misses = tracking.active - tracking.returns;
  figures.id_switches = tracking.id_switches;
  for (const InstantFigures& instant : evaluation.instants)
    figures.false_objects += instant.not_real;
  figures.setMota();
  return figures;
}

IdentityFigures identityFigures(const Evaluation& evaluation) {
  std::vector<IdentityView> views;
  for (const InstantFigures& instant : evaluation.instants) views.push_back(instant.identities);
  return identityFigures(views);
}

CountDifference countDifference(const TrackedRun& run, const TrackedRun& reference) {
  const auto classified = [](const Scene& scene) {
    return std::count_if(scene.objects.begin(), scene.objects.end(),
                         [](const SceneObject& o) { return o.classified; });
  };
  std::map<std::int64_t, const Scene*> by_stamp;
  for (const Scene& scene : reference.scenes) by_stamp.emplace(scene.stamp.ns, &scene);
  CountDifference result;
  Sum all, named;
  for (const Scene& scene : run.scenes) {
    const auto other = by_stamp.find(scene.stamp.ns);
    if (other == by_stamp.end()) continue;
    ++result.instants;
    all.add(static_cast<double>(scene.objects.size()) -
            static_cast<double>(other->second->objects.size()));
    named.add(static_cast<double>(classified(scene) - classified(*other->second)));
  }
  result.all = all.rms();
  result.classified = named.rms();
  return result;
}

}  // namespace perception
