#include "libperception/scene/files/TrackedRun.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include "libperception/core/PoseSteps.h"
#include "libperception/scene/files/NumberFormat.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {
namespace {

constexpr double kPoseGap =
    1.5;  // [s] between scenes over which the vehicle's place is interpolated

// A line of fields separated by commas.
class Line {
 public:
  void text(std::string_view field) {
    if (!line_.empty()) line_ += ',';
    line_ += field;
  }
  template <class Integer>
  void integer(Integer value) {
    text(fmt::format("{}", value));
  }
  void time(Stamp later, Stamp earlier) { text(decimalSeconds(later.ns - earlier.ns)); }
  void meters(double value) { text(fixedPlaces(value, kMeterPlaces)); }
  void radians(double value) { text(fixedPlaces(value, kRadianPlaces)); }
  void probability(double value) { text(fixedPlaces(value, kProbabilityPlaces)); }
  const std::string& end() { return line_ += '\n'; }

 private:
  std::string line_;
};

void addInstant(Line& line, const Scene& scene, Stamp first_stamp) {
  line.integer(scene.frame);
  line.time(scene.stamp, first_stamp);
  line.text(decimalSeconds(scene.stamp.ns));
}

std::string tracksHeader(const ClassTable& classes) {
  Line line;
  line.text("frame,t,stamp,id,class,classified");
  for (const ObjectClass& c : classes.classes) line.text("p_" + c.name);
  line.text(
      "existence,x,y,z,yaw,has_yaw,p_front,vx,vy,speed,length,width,height,sd_x,sd_y,sd_yaw,sd_"
      "speed");
  for (const ModalityRow& m : modalities()) line.text(lastHitColumn(m));
  return line.end();
}

std::string trackLine(const Scene& scene, const SceneObject& object, const ClassTable& classes,
                      Stamp first_stamp) {
  Line line;
  addInstant(line, scene, first_stamp);
  line.integer(object.id);
  line.text(classes[object.class_id].name);
  line.integer(object.classified ? 1 : 0);
  for (const double p : object.class_probability) line.probability(p);
  line.probability(object.existence);
  for (const double v : object.position) line.meters(v);
  line.radians(object.yaw);
  line.integer(object.has_yaw ? 1 : 0);
  line.probability(object.p_front);
  for (const double v : object.velocity) line.meters(v);
  line.meters(object.speed);
  for (const double v : {object.length, object.width, object.height}) line.meters(v);
  line.meters(object.sd_x);
  line.meters(object.sd_y);
  line.radians(object.sd_yaw);
  line.meters(object.sd_speed);
  for (const ModalityRow& m : modalities()) {
    const auto hit = object.last_hit.find(m.letter);
    if (hit == object.last_hit.end()) {
      line.text("");
    } else {
      line.time(hit->second, first_stamp);
    }
  }
  return line.end();
}

void addCause(Line& line, const FreePath& path) {
  if (!path.blocked) return line.text(",,,");
  line.text(path.owner == 0 ? "unknown" : fmt::format("{}", path.owner));
  line.text(kPathCauses[static_cast<std::size_t>(path.cause)]);
  line.integer(path.returns);
  line.integer(path.overruled);
}

void addPath(Line& line, const std::optional<FreePath>& path) {
  if (!path) return line.text(",,,,,,,,");
  line.meters(path->distance);
  line.meters(path->seen);
  line.integer(path->stop ? 1 : 0);
  addCause(line, *path);
  line.meters(path->safe_speed);
  line.integer(path->too_fast ? 1 : 0);
}

std::string sceneLine(const Scene& scene, std::size_t objects, Stamp first_stamp) {
  Line line;
  addInstant(line, scene, first_stamp);
  const Pose3& pose = scene.ego.T_world_ego;
  for (const double v : pose.translation()) line.meters(v);
  for (const double v : {yawOf(pose), pitchOf(pose), rollOf(pose)}) line.radians(v);
  for (const double v : scene.ego.velocity) line.meters(v);
  line.radians(scene.ego.yaw_rate);
  line.integer(objects);
  addPath(line, scene.path);
  return line.end();
}

bool isFinite(const SceneObject& o) {
  for (const double p : o.class_probability) {
    if (!std::isfinite(p)) return false;
  }
  for (const double v : {o.existence, o.yaw, o.p_front, o.speed, o.length, o.width, o.height,
                         o.sd_x, o.sd_y, o.sd_yaw, o.sd_speed}) {
    if (!std::isfinite(v)) return false;
  }
  return o.position.allFinite() && o.velocity.allFinite();
}

}  // namespace

TrackedRunWriter::TrackedRunWriter(const std::string& dir, const ClassTable& classes,
                                   Stamp first_stamp)
    : tracks_(tracksFileOf(dir)),
      scenes_(scenesFileOf(dir)),
      classes_(classes),
      first_stamp_(first_stamp) {
  tracks_.write(tracksHeader(classes_));
  scenes_.write(
      "frame,t,stamp,x,y,z,yaw,pitch,roll,vx,vy,yaw_rate,objects,free_distance,free_seen,stop,"
      "obstacle,cause,returns,overruled,safe_speed,too_fast\n");
}

void TrackedRunWriter::write(const Scene& scene) {
  std::size_t written = 0;
  for (const SceneObject& object : scene.objects) {
    assert(object.class_probability.size() == classes_.classes.size());
    if (!isFinite(object)) {
      ++not_finite_;
      continue;
    }
    tracks_.write(trackLine(scene, object, classes_, first_stamp_));
    ++written;
  }
  scenes_.write(sceneLine(scene, written, first_stamp_));
}

void TrackedRunWriter::close() {
  tracks_.close();
  scenes_.close();
}

TrackedRun readTrackedRun(const std::string& dir) {
  TrackedRunReader reader(dir);
  TrackedRun run{dir, reader.firstStamp(), reader.classNames(), {}};
  while (auto scene = reader.next()) run.scenes.push_back(std::move(*scene));
  return run;
}

std::optional<EgoState> egoAt(const TrackedRun& run, Stamp stamp) {
  const auto after = std::lower_bound(run.scenes.begin(), run.scenes.end(), stamp,
                                      [](const Scene& s, Stamp t) { return s.stamp < t; });
  if (after == run.scenes.end()) return std::nullopt;
  if (after->stamp == stamp) return after->ego;
  if (after == run.scenes.begin()) return std::nullopt;
  const EgoState &a = std::prev(after)->ego, &b = after->ego;
  const double gap = after->stamp - std::prev(after)->stamp;
  if (gap > kPoseGap) return std::nullopt;
  EgoState ego = a;
  ego.stamp = stamp;
  ego.T_world_ego =
      interpolate(a.T_world_ego, b.T_world_ego, (stamp - std::prev(after)->stamp) / gap);
  return ego;
}

}  // namespace perception
