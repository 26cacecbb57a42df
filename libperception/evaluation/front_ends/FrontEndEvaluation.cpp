#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"

namespace perception {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// A truth object at a scan.
struct SeenObject {
  const TruthObject* object;
  ClassId class_id;  // -1: no class of the run
  Footprint footprint;
  double reach;  // [m] from the center to the corners
};

bool isPersonSized(const SeenObject& seen, const FrontEndOptions& options) {
  return std::max(seen.footprint.length, seen.footprint.width) < options.person_side;
}

// Name of a truth object in the tables: poles and hedges have one truth type, so their size is
// added.
std::string kindOf(const SeenObject& seen, const FrontEndOptions& options) {
  const TruthObject& object = *seen.object;
  if (seen.class_id >= 0 || !object.ignore) return object.type;
  return object.type + (isPersonSized(seen, options) ? ", person-sized" : ", larger");
}

// Normalized distance of a measurement from a footprint; <= 1: on the object.
double offset(const RecordedMeasurement& m, const SeenObject& seen, const Vector2& sensor,
              const FrontEndOptions& options) {
  const Vector2 d = m.position - closestPoint(seen.footprint, m.position);
  const Vector2 sight = m.position - sensor;
  const double range = sight.norm();
  if (range <= 0) return d.norm() / options.margin;
  const Vector2 u = sight / range;
  const double along = d.dot(u), across = d.dot(Vector2(-u.y(), u.x()));
  return std::hypot(along / (options.margin + options.deviations * m.sd_range),
                    across / (options.margin + options.deviations * m.sd_across));
}

// Compares the scans of one sensor with the truth.
class ScanJudge {
 public:
  ScanJudge(const MeasurementRun& run, const RecordedSensor& sensor, const FrontEndOptions& options,
            FrontEndEvaluation& result)
      : run_(run), sensor_(sensor), options_(options), result_(result) {
    for (const std::string& label : sensor.labels)
      meanings_[label] = meaningOf(label, run.class_names);
  }

  void add(const RecordedScan& scan, const std::vector<TruthObject>& truth) {
    ++result_.scans;
    result_.measurements += scan.measurements.size();
    const std::vector<SeenObject> things = thingsAround(scan, truth);
    std::vector<RecallCounts> found(things.size());
    const Vector2 sensor = scan.T_world_sensor.translation().head<2>();
    for (const RecordedMeasurement& m : scan.measurements) {
      const int on = thingUnder(m, things, sensor);
      if (on >= 0) countFound(m, things[static_cast<std::size_t>(on)], found[std::size_t(on)]);
      if (isJudged(scan, m)) countLabel(m, on < 0 ? nullptr : &things[std::size_t(on)]);
    }
    for (std::size_t i = 0; i < things.size(); ++i) countRecall(scan, things[i], found[i]);
  }

 private:
  const LabelMeaning& meaning(const std::string& label) {
    const auto known = meanings_.find(label);
    if (known != meanings_.end()) return known->second;
    return meanings_[label] = meaningOf(label, run_.class_names);
  }

  std::vector<SeenObject> thingsAround(const RecordedScan& scan,
                                       const std::vector<TruthObject>& truth) const {
    std::vector<SeenObject> things;
    const double ground = scan.T_world_ego.translation().z();
    for (const TruthObject& object : truth) {
      if (isArea(object) || !object.position.head<2>().allFinite()) continue;
      if (object.position.z() - ground > options_.overhead) continue;
      SeenObject seen{&object, classOfTruth(object.type, run_.class_names),
                      makeFootprint(object.position, object.yaw, object.length, object.width), 0};
      seen.reach = 0.5 * std::hypot(seen.footprint.length, seen.footprint.width);
      things.push_back(seen);
    }
    return things;
  }

  // Index of the nearest object that the measurement lies on, or -1; of several footprints that
  // contain it, the one with the nearest center.
  int thingUnder(const RecordedMeasurement& m, const std::vector<SeenObject>& things,
                 const Vector2& sensor) const {
    const double most = options_.margin + options_.deviations * std::max(m.sd_range, m.sd_across);
    int best = -1;
    double best_offset = 1, best_distance = 0;
    for (std::size_t i = 0; i < things.size(); ++i) {
      const double distance = (things[i].footprint.center - m.position).norm();
      if (distance > things[i].reach + most) continue;
      const double o = offset(m, things[i], sensor, options_);
      if (o > 1) continue;
      if (best < 0 || o < best_offset || (o == best_offset && distance < best_distance)) {
        best = static_cast<int>(i), best_offset = o, best_distance = distance;
      }
    }
    return best;
  }

  bool names(const LabelMeaning& meaning, ClassId c) const {
    if (c < 0) return false;
    if (meaning.classes.empty()) return true;
    return contains(meaning.classes, run_.class_names[static_cast<std::size_t>(c)]);
  }

  void countFound(const RecordedMeasurement& m, const SeenObject& thing, RecallCounts& found) {
    ++found.measurements;
    found.found = 1;
    const LabelMeaning& says = meaning(m.label);
    if (!names(says, thing.class_id)) return;
    found.named = 1;
    if (says.primary) found.named_primary = 1;
  }

  std::size_t binOf(double range) const {
    const auto& edges = options_.range_edges;
    const auto above = std::upper_bound(edges.begin(), edges.end(), range);
    const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - edges.begin(), 1));
    return std::min(place, edges.size() - 1) - 1;
  }

  // A measurement can be false only where the truth is complete.
  bool isJudged(const RecordedScan& scan, const RecordedMeasurement& m) const {
    const Vector2 sight = m.position - scan.T_world_ego.translation().head<2>();
    const double bearing = wrapAngle(std::atan2(sight.y(), sight.x()) - yawOf(scan.T_world_ego));
    return std::abs(bearing) <= 0.5 * options_.selection.complete_fov;
  }

  void countLabel(const RecordedMeasurement& m, const SeenObject* thing) {
    auto& bins = result_.labels[m.label];
    bins.resize(result_.bins());
    PrecisionCounts& counts = bins[binOf(m.range)];
    ++counts.measurements;
    ++counts.on[thing ? kindOf(*thing, options_) : kNothing];
    if (!thing) return;
    const LabelMeaning& says = meaning(m.label);
    if (names(says, thing->class_id)) ++counts.right_class;
    const bool person = isPersonSized(*thing, options_);
    if (says.size == LabelMeaning::Size::kAny ||
        (says.size == LabelMeaning::Size::kPerson) == person)
      ++counts.right_size;
  }

  void countRecall(const RecordedScan& scan, const SeenObject& thing, RecallCounts counts) {
    const TruthObject& object = *thing.object;
    if (thing.class_id < 0 || object.ignore) return;
    const auto c = static_cast<std::size_t>(thing.class_id);
    const GroundView view = viewFrom(scan.T_world_sensor, thing.footprint);
    const double range = options_.center_range ? view.range : view.closest_range;
    const bool in_view = range <= sensor_.class_range[c] && view.range >= sensor_.range_min &&
                         std::abs(view.bearing) <= 0.5 * sensor_.fov;
    if (!in_view || object.occluded > options_.selection.max_occluded) return;
    const std::size_t bin = binOf(range);
    counts.in_view = 1;
    result_.visible[c][bin] += counts;
    if (object.lidar_points < 0 || object.lidar_points >= options_.selection.min_points)
      result_.with_points[c][bin] += counts;
  }

  const MeasurementRun& run_;
  const RecordedSensor& sensor_;
  const FrontEndOptions& options_;
  FrontEndEvaluation& result_;
  std::map<std::string, LabelMeaning> meanings_;
};

// The stamps of one sensor's scans as scenes, for alignTruth().
TrackedRun instantsOf(const MeasurementRun& run, std::size_t sensor,
                      std::vector<const RecordedScan*>& scans) {
  TrackedRun instants;
  instants.first_stamp = run.first_stamp;
  instants.class_names = run.class_names;
  for (const RecordedScan& scan : run.scans) {
    if (scan.sensor != sensor) continue;
    scans.push_back(&scan);
    Scene scene;
    scene.stamp = scan.stamp;
    scene.frame = scan.frame;
    scene.ego.T_world_ego = scan.T_world_ego;
    instants.scenes.push_back(std::move(scene));
  }
  return instants;
}

template <class Counts>
void addTo(std::vector<Counts>& to, const std::vector<Counts>& from) {
  to.resize(std::max(to.size(), from.size()));
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += from[i];
}

}  // namespace

LabelMeaning meaningOf(const std::string& label, const std::vector<std::string>& class_names) {
  using Size = LabelMeaning::Size;
  const std::vector<std::string> persons = {"pedestrian", "cyclist"}, vehicles = {"car", "bus"};
  if (label == "car_sized") return {vehicles, Size::kVehicle, true};
  if (label == "unstable") return {vehicles, Size::kVehicle, false};
  if (label == "person_sized") return {persons, Size::kPerson, true};
  if (label == "car") return {vehicles, Size::kVehicle, true, false};
  if (label == "person") return {persons, Size::kPerson, true, false};
  if (contains(class_names, label)) return {{label}, Size::kAny, true};
  return {};
}

RecallCounts FrontEndEvaluation::recall(const std::vector<std::string>& classes,
                                        bool points) const {
  RecallCounts sum;
  for (std::size_t c = 0; c < class_names.size(); ++c) {
    if (!contains(classes, class_names[c])) continue;
    for (const RecallCounts& bin : (points ? with_points : visible)[c]) sum += bin;
  }
  return sum;
}

PrecisionCounts FrontEndEvaluation::precision(const std::string& label) const {
  PrecisionCounts sum;
  const auto found = labels.find(label);
  if (found == labels.end()) return sum;
  for (const PrecisionCounts& bin : found->second) sum += bin;
  return sum;
}

FrontEndEvaluation& FrontEndEvaluation::operator+=(const FrontEndEvaluation& other) {
  if (other.class_names != class_names || other.range_edges != range_edges) {
    throw DataError(fmt::format("{}: runs with different classes cannot be pooled", name));
  }
  sensors = std::max(sensors, other.sensors);
  scans += other.scans;
  scans_without_truth += other.scans_without_truth;
  measurements += other.measurements;
  surroundings = surroundings && other.surroundings;
  for (std::size_t c = 0; c < class_names.size(); ++c) {
    addTo(visible[c], other.visible[c]);
    addTo(with_points[c], other.with_points[c]);
  }
  for (const auto& [label, bins_of_label] : other.labels) addTo(labels[label], bins_of_label);
  return *this;
}

FrontEndEvaluation evaluateFrontEnd(const MeasurementRun& run, const std::string& pattern,
                                    const GroundTruth& truth, const FrontEndOptions& options) {
  FrontEndEvaluation result;
  result.name = pattern;
  result.class_names = run.class_names;
  result.range_edges = options.range_edges;
  result.surroundings = options.surroundings;
  result.visible.assign(run.class_names.size(), std::vector<RecallCounts>(result.bins()));
  result.with_points = result.visible;
  std::string known;
  for (std::size_t s = 0; s < run.sensors.size(); ++s) {
    const RecordedSensor& sensor = run.sensors[s];
    known += (known.empty() ? "" : ", ") + sensor.label;
    if (fnmatch(pattern.c_str(), sensor.label.c_str(), 0) != 0) continue;
    ++result.sensors;
    std::vector<const RecordedScan*> scans;
    const TruthAlignment alignment =
        alignTruth(instantsOf(run, s, scans), truth, options.alignment);
    result.scans_without_truth += alignment.scenes_without_truth;
    ScanJudge judge(run, sensor, options, result);
    for (const TruthAtScene& instant : alignment.instants)
      judge.add(*scans[instant.scene], instant.objects);
  }
  if (result.sensors == 0) {
    throw DataError(fmt::format("{}/sensors.csv: no sensor matches '{}'; there are: {}", run.dir,
                                pattern, known));
  }
  return result;
}

}  // namespace perception
