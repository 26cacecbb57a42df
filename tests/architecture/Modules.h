#pragma once
#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace perception::test {

/// A module: a folder below libperception, or one beside it.
struct Module {
  std::string name;
  std::string what;                   ///< what it does, for docs/structure.svg
  std::set<std::string> may_include;  ///< other modules
  bool chain = false;                 ///< main dependency chain: core to pipeline
  int stage = 0;                      ///< order of processing from log to scene; 0: none
};

/// Allowed dependencies; each module comes after those it may include. Checked by Layers_test;
/// docs/structure.svg is drawn from it.
inline const std::vector<Module>& modules() {
  static const std::vector<Module> all = {
      {"core", "poses, angles, time, random numbers, errors, truth files", {}, true},
      {"config", "strict INI files, each key documented", {"core"}},
      {"simd", "loops over returns for several vector widths", {}},
      {"measurement",
       "frames, measurements z and R, measurement models h, object classes",
       {"config", "core"},
       true},
      // Front ends and weather: no filter, no sensors.
      {"weather",
       "trust: P(a return is not rain or snow)",
       {"measurement", "simd", "config", "core"},
       false,
       2},
      {"lidar",
       "ground, clusters and what they look like, person peaks",
       {"measurement", "simd", "config", "core"},
       false,
       3},
      {"odometry", "the vehicle's motion from scans", {"lidar", "measurement", "core"}},
      {"radar", "targets with range rate", {"measurement", "core"}, false, 3},
      {"vision", "image boxes as outlines", {"measurement", "config", "core"}, false, 3},
      {"boxes3d", "boxes in space as positions", {"measurement", "config", "core"}, false, 3},
      {"detectors", "finds boxes in images", {"measurement", "simd", "config", "core"}},
      {"grid", "safety grid: free distance", {"simd", "config", "core"}},
      {"filter",
       "hypotheses of associations, a bank of class filters for every track",
       {"measurement", "simd", "config", "core"},
       true,
       4},
      {"sensors",
       "reads and decodes logs, estimates the ego pose",
       {"measurement", "config", "core"},
       false,
       1},
      {"scene",
       "list of objects from the posterior; result files",
       {"filter", "measurement", "config", "core"},
       true,
       5},
      {"pipeline",
       "runs one log: reader, weather, front ends, filter, scene",
       {"scene", "filter", "sensors", "grid", "weather", "lidar", "odometry", "radar", "boxes3d",
        "vision", "measurement", "config", "core"},
       true},
      {"evaluation", "tracks against truth", {"scene", "measurement", "core"}},
      {"doctor",
       "examines a log, writes a first INI",
       {"pipeline", "evaluation", "odometry", "lidar", "sensors", "measurement", "core"}},
      {"gui-offscreen", "pictures, films, pages", {"scene", "grid", "measurement", "core"}},
      {"interop",
       "logs and tracks in the formats of other tools, and back",
       {"scene", "grid", "measurement", "config", "core"}},
      {"packets", "decodes packets of real sensors", {"measurement", "core"}},
      {"importers",
       "other recordings to rawlogs",
       {"interop", "packets", "sensors", "config", "measurement", "core"}},
      {"simulation", "scenarios to rawlogs", {"sensors", "measurement", "config", "core"}},
      {"dds",
       "observations and scenes between processes and computers",
       {"interop", "sensors", "scene", "grid", "measurement", "core"}},
      {"live",
       "shows a run as it goes on: page, Foxglove's protocol, ROS 2",
       {"pipeline", "dds", "interop", "gui-offscreen", "scene", "grid", "weather", "measurement",
        "config", "core"}},
      {"detection",
       "detects in images and logs, compares with labels",
       {"detectors", "pipeline", "importers", "gui-offscreen", "scene", "sensors", "measurement",
        "config", "core"}},
      {"capture",
       "recorder, drivers, device simulators",
       {"dds", "importers", "interop", "packets", "simulation", "grid", "sensors", "measurement",
        "config", "core"}},
      {"calibration",
       "fits parameters by their likelihood, learns what clusters look like",
       {"pipeline", "evaluation", "scene", "sensors", "lidar", "boxes3d", "measurement", "config",
        "core"}},
      {"batch",
       "many runs: plan, processes, queue, figures of all",
       {"pipeline", "evaluation", "gui-offscreen", "scene", "config", "core"}},
      {"pictures",
       "draws scenarios and runs, makes pages",
       {"pipeline", "gui-offscreen", "simulation", "evaluation", "scene", "grid", "weather",
        "lidar", "sensors", "config", "core"}},
      {"app",
       "command lines of the programs",
       {"pictures",  "batch",       "doctor",        "pipeline", "calibration", "importers",
        "interop",   "capture",     "dds",           "live",     "simulation",  "detection",
        "detectors", "evaluation",  "gui-offscreen", "boxes3d",  "scene",       "grid",
        "sensors",   "measurement", "config",        "core"}},
      {"python",
       "the module perception of Python",
       {"app", "pipeline", "scene", "sensors", "boxes3d", "measurement", "config", "core"}},
      {"studies",
       "experiments about the method",
       {"app", "pictures", "pipeline", "calibration", "simulation", "detectors", "evaluation",
        "scene", "filter", "lidar", "grid", "sensors", "measurement", "config", "core"}},
      {"apps", "a short main for every program", {"app"}},
  };
  return all;
}

/// Null where the table has no such module.
inline const Module* moduleNamed(const std::string& name) {
  for (const Module& module : modules()) {
    if (module.name == name) return &module;
  }
  return nullptr;
}

/// What the module includes, without what comes with another of them.
inline std::vector<std::string> nearestBelow(const Module& module) {
  std::vector<std::string> near;
  for (const Module& other : modules()) {
    if (module.may_include.count(other.name) == 0) continue;
    const bool comes_along = std::any_of(
        module.may_include.begin(), module.may_include.end(),
        [&](const auto& name) { return moduleNamed(name)->may_include.count(other.name) != 0; });
    if (!comes_along) near.push_back(other.name);
  }
  return near;
}

}  // namespace perception::test
