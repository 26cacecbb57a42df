#include "libperception/scene/files/TrackedRun.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr double kPoseGap =
    1.5;  // [s] between scenes over which the vehicle's place is interpolated

std::string tracksPath(const std::string& dir) { return dir + "/tracks.csv"; }
std::string scenesPath(const std::string& dir) { return dir + "/scenes.csv"; }
std::string lastHitColumn(const ModalityRow& m) {
  return fmt::format("last_hit_{}", letterOf(m.letter));
}

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

/// As FreePath::Cause.
constexpr std::array<const char*, 3> kPathCauses = {"grid", "returns", "object"};

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

// A CSV table with typed access by column name; caches the column indices.
class Table {
 public:
  explicit Table(const std::string& path) : csv_(CsvTable::fromFile(path)) {}

  const CsvTable& csv() const { return csv_; }
  void go(std::size_t row) { row_ = row; }
  double real(const char* name) const { return csv_.real(row_, csv_.column(name)); }
  bool has(const char* name) const { return csv_.has(name); }
  bool flag(const char* name) const { return csv_.flag(row_, csv_.column(name)); }
  std::int64_t integer(const char* name) const { return csv_.integer(row_, csv_.column(name)); }
  std::uint64_t natural(const char* name) const { return csv_.natural(row_, csv_.column(name)); }
  std::string_view text(const char* name) const { return csv_.text(row_, csv_.column(name)); }
  /// [ns] of a column of exact seconds.
  std::int64_t nanoseconds(const char* name) const {
    std::int64_t ns = 0;
    if (!parseDecimalSeconds(text(name), ns))
      fault(name, "seconds with at most nine decimal places");
    return ns;
  }
  [[noreturn]] void fault(const char* name, const std::string& expected) const {
    csv_.fault(row_, csv_.column(name), expected);
  }

 private:
  CsvTable csv_;
  std::size_t row_ = 0;
};

std::optional<FreePath> readPath(const Table& row) {
  if (row.text("free_distance").empty()) return std::nullopt;
  FreePath path;
  path.distance = row.real("free_distance");
  path.seen = row.real("free_seen");
  path.stop = row.flag("stop");
  path.blocked = !row.text("obstacle").empty();
  if (path.blocked && row.text("obstacle") != "unknown") path.owner = row.natural("obstacle");
  if (row.has("safe_speed")) {
    path.safe_speed = row.real("safe_speed");
    path.too_fast = row.flag("too_fast");
  }
  if (!path.blocked || !row.has("cause")) return path;  // older runs have none
  const auto cause = std::find(kPathCauses.begin(), kPathCauses.end(), row.text("cause"));
  if (cause == kPathCauses.end()) row.fault("cause", "grid, returns or object");
  path.cause = static_cast<FreePath::Cause>(cause - kPathCauses.begin());
  path.returns = static_cast<std::uint32_t>(row.natural("returns"));
  path.overruled = static_cast<std::uint32_t>(row.natural("overruled"));
  return path;
}

Scene readScene(const Table& row) {
  Scene scene;
  scene.frame = row.integer("frame");
  scene.stamp.ns = row.nanoseconds("stamp");
  scene.ego.stamp = scene.stamp;
  scene.ego.T_world_ego = makePose(row.real("x"), row.real("y"), row.real("z"), row.real("yaw"),
                                   row.real("pitch"), row.real("roll"));
  scene.ego.velocity = {row.real("vx"), row.real("vy")};
  scene.ego.yaw_rate = row.real("yaw_rate");
  scene.path = readPath(row);
  return scene;
}

SceneObject readObject(const Table& row, const std::vector<std::string>& classes,
                       Stamp first_stamp) {
  SceneObject o;
  o.id = row.natural("id");
  const auto found = std::find(classes.begin(), classes.end(), row.text("class"));
  if (found == classes.end()) row.fault("class", "the name of a column p_NAME");
  o.class_id = static_cast<ClassId>(found - classes.begin());
  o.classified = row.flag("classified");
  for (const std::string& name : classes)
    o.class_probability.push_back(row.real(("p_" + name).c_str()));
  o.existence = row.real("existence");
  o.position = {row.real("x"), row.real("y"), row.real("z")};
  o.yaw = row.real("yaw");
  o.has_yaw = row.flag("has_yaw");
  if (row.has("p_front")) o.p_front = row.real("p_front");  // older runs have none
  o.velocity = {row.real("vx"), row.real("vy")};
  o.speed = row.real("speed");
  o.length = row.real("length"), o.width = row.real("width"), o.height = row.real("height");
  o.sd_x = row.real("sd_x"), o.sd_y = row.real("sd_y");
  o.sd_yaw = row.real("sd_yaw"), o.sd_speed = row.real("sd_speed");
  for (const ModalityRow& m : modalities()) {
    const std::string name = lastHitColumn(m);
    if (row.text(name.c_str()).empty()) continue;
    o.last_hit[m.letter] = Stamp{first_stamp.ns + row.nanoseconds(name.c_str())};
  }
  return o;
}

}  // namespace

TrackedRunWriter::TrackedRunWriter(const std::string& dir, const ClassTable& classes,
                                   Stamp first_stamp)
    : tracks_(tracksPath(dir)),
      scenes_(scenesPath(dir)),
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
  Table scenes(scenesPath(dir)), tracks(tracksPath(dir));
  TrackedRun run;
  run.dir = dir;
  for (const std::string& name : tracks.csv().header()) {
    if (name == "existence") break;  // p_front, further on, is no class
    if (name.rfind("p_", 0) == 0) run.class_names.push_back(name.substr(2));
  }
  std::size_t next = 0;  // line of tracks.csv: they stand in the order of the scenes
  for (std::size_t i = 0; i < scenes.csv().rows(); ++i) {
    scenes.go(i);
    Scene scene = readScene(scenes);
    if (i == 0) run.first_stamp = Stamp{scene.stamp.ns - scenes.nanoseconds("t")};
    if (i > 0 && scene.stamp < run.scenes.back().stamp)
      scenes.fault("stamp", "scenes in order of time");
    for (std::uint64_t objects = scenes.natural("objects"); objects > 0; --objects, ++next) {
      if (next == tracks.csv().rows()) {
        scenes.fault("objects",
                     fmt::format("{} fewer: tracks.csv ends before (was it cut?)", objects));
      }
      tracks.go(next);
      if (tracks.nanoseconds("stamp") != scene.stamp.ns) {
        tracks.fault("stamp", fmt::format("{}, the scene of {}:{}", decimalSeconds(scene.stamp.ns),
                                          scenes.csv().name(), scenes.csv().lineOf(i)));
      }
      scene.objects.push_back(readObject(tracks, run.class_names, run.first_stamp));
    }
    run.scenes.push_back(std::move(scene));
  }
  if (next < tracks.csv().rows()) {
    tracks.go(next);
    tracks.fault("stamp", "no further line: scenes.csv has no scene for it");
  }
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
  const double share = (stamp - std::prev(after)->stamp) / gap;
  EgoState ego = a;
  ego.stamp = stamp;
  ego.T_world_ego.translation() +=
      share * (b.T_world_ego.translation() - a.T_world_ego.translation());
  ego.T_world_ego.linear() = Eigen::Quaterniond(a.T_world_ego.linear())
                                 .slerp(share, Eigen::Quaterniond(b.T_world_ego.linear()))
                                 .toRotationMatrix();
  return ego;
}

}  // namespace perception
