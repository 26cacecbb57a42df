#include "libperception/scene/files/TrackedRunReader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

#include "libperception/core/CsvStream.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

// The rows of a table, one at a time, with typed access by column name.
class Row {
 public:
  explicit Row(const std::string& path) : stream_(path) {}

  const CsvTable& csv() const { return stream_.row(); }
  bool next() { return stream_.next(); }
  double real(const char* name) const { return csv().real(0, column(name)); }
  bool has(const char* name) const { return csv().has(name); }
  bool flag(const char* name) const { return csv().flag(0, column(name)); }
  std::int64_t integer(const char* name) const { return csv().integer(0, column(name)); }
  std::uint64_t natural(const char* name) const { return csv().natural(0, column(name)); }
  std::string_view text(const char* name) const { return csv().text(0, column(name)); }
  /// [ns] of a column of exact seconds.
  std::int64_t nanoseconds(const char* name) const {
    std::int64_t ns = 0;
    if (!parseDecimalSeconds(text(name), ns))
      fault(name, "seconds with at most nine decimal places");
    return ns;
  }
  [[noreturn]] void fault(const char* name, const std::string& expected) const {
    csv().fault(0, column(name), expected);
  }

 private:
  // Columns by the address of their name, in the order in which they are asked for: nearly the same
  // in each row.
  CsvTable::Column column(const char* name) const {
    for (std::size_t i = 0; i < known_.size(); ++i) {
      if (++cursor_ >= known_.size()) cursor_ = 0;
      if (known_[cursor_].first == name) return known_[cursor_].second;
    }
    known_.emplace_back(name, csv().column(name));
    cursor_ = known_.size() - 1;
    return known_.back().second;
  }

  CsvStream stream_;
  mutable std::vector<std::pair<const char*, CsvTable::Column>> known_;
  mutable std::size_t cursor_ = 0;
};

/// Columns of tracks.csv whose names depend on the run.
struct ObjectColumns {
  std::vector<std::string> probabilities;  ///< by class
  std::vector<std::pair<Modality, std::string>> last_hits;
};

std::optional<FreePath> readPath(const Row& row) {
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

Scene readScene(const Row& row) {
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

SceneObject readObject(const Row& row, const std::vector<std::string>& classes,
                       const ObjectColumns& columns, Stamp first_stamp) {
  SceneObject o;
  o.id = row.natural("id");
  const auto found = std::find(classes.begin(), classes.end(), row.text("class"));
  if (found == classes.end()) row.fault("class", "the name of a column p_NAME");
  o.class_id = static_cast<ClassId>(found - classes.begin());
  o.classified = row.flag("classified");
  for (const std::string& name : columns.probabilities)
    o.class_probability.push_back(row.real(name.c_str()));
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
  for (const auto& [modality, name] : columns.last_hits) {
    if (row.text(name.c_str()).empty()) continue;
    o.last_hit[modality] = Stamp{first_stamp.ns + row.nanoseconds(name.c_str())};
  }
  return o;
}

}  // namespace

std::string tracksFileOf(const std::string& dir) { return dir + "/tracks.csv"; }
std::string scenesFileOf(const std::string& dir) { return dir + "/scenes.csv"; }
std::string lastHitColumn(const ModalityRow& modality) {
  return fmt::format("last_hit_{}", letterOf(modality.letter));
}

struct TrackedRunReader::Tables {
  explicit Tables(const std::string& dir) : scenes(scenesFileOf(dir)), tracks(tracksFileOf(dir)) {
    for (const std::string& name : tracks.csv().header()) {
      if (name == "existence") break;  // p_front, further on, is no class
      if (name.rfind("p_", 0) == 0) class_names.push_back(name.substr(2));
    }
    for (const std::string& name : class_names) columns.probabilities.push_back("p_" + name);
    for (const ModalityRow& m : modalities())
      columns.last_hits.emplace_back(m.letter, lastHitColumn(m));
    more = scenes.next();
    if (more) first_stamp = Stamp{scenes.nanoseconds("stamp") - scenes.nanoseconds("t")};
  }

  Row scenes, tracks;
  std::vector<std::string> class_names;
  ObjectColumns columns;
  Stamp first_stamp;
  std::optional<Stamp> last;  // scene before
  bool more = false;          // `scenes` has a row that was not given out
  bool ended = false;
};

TrackedRunReader::TrackedRunReader(const std::string& dir)
    : tables_(std::make_unique<Tables>(dir)) {}

TrackedRunReader::~TrackedRunReader() = default;

Stamp TrackedRunReader::firstStamp() const { return tables_->first_stamp; }

const std::vector<std::string>& TrackedRunReader::classNames() const {
  return tables_->class_names;
}

std::optional<Scene> TrackedRunReader::next() {
  Row &scenes = tables_->scenes, &tracks = tables_->tracks;
  if (!tables_->more) {
    if (!tables_->ended && tracks.next())
      tracks.fault("stamp", "no further line: scenes.csv has no scene for it");
    tables_->ended = true;
    return std::nullopt;
  }
  Scene scene = readScene(scenes);
  if (tables_->last && scene.stamp < *tables_->last)
    scenes.fault("stamp", "scenes in order of time");
  tables_->last = scene.stamp;
  for (std::uint64_t objects = scenes.natural("objects"); objects > 0; --objects) {
    if (!tracks.next()) {
      scenes.fault("objects",
                   fmt::format("{} fewer: tracks.csv ends before (was it cut?)", objects));
    }
    if (tracks.nanoseconds("stamp") != scene.stamp.ns) {
      tracks.fault("stamp", fmt::format("{}, the scene of {}:{}", decimalSeconds(scene.stamp.ns),
                                        scenes.csv().name(), scenes.csv().lineOf(0)));
    }
    scene.objects.push_back(
        readObject(tracks, tables_->class_names, tables_->columns, tables_->first_stamp));
  }
  tables_->more = scenes.next();
  return scene;
}

std::vector<Scene> TrackedRunReader::next(std::size_t count) {
  std::vector<Scene> scenes;
  while (scenes.size() < count) {
    auto scene = next();
    if (!scene) break;
    scenes.push_back(std::move(*scene));
  }
  return scenes;
}

RunOutline readRunOutline(const std::string& dir) {
  const TrackedRunReader run(dir);
  RunOutline outline{dir, run.firstStamp(), run.classNames(), {}};
  for (Row scenes(scenesFileOf(dir)); scenes.next();)
    outline.stamps.push_back(Stamp{scenes.nanoseconds("stamp")});
  return outline;
}

}  // namespace perception
