#include "libperception/pictures/pages/SnapshotViews.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/pictures/RunScenes.h"

namespace perception {
namespace {

/// Parses one view name of --view.
struct ViewRow {
  const char* name;
  ViewKind kind;
};
constexpr ViewRow kViews[] = {
    {"top", ViewKind::kTop}, {"driver", ViewKind::kDriver}, {"camera", ViewKind::kCamera}};

SceneView viewOf(const ShownRun& shown, std::size_t index, const GroundTruth* truth,
                 const std::vector<ViewKind>& views) {
  SceneView result = viewOfScene(shown.run, index, truth);
  result.run_name = shown.name;
  if (shown.sensors) {
    shown.sensors->advanceTo(result.scene.stamp);
    shown.sensors->fill(result);
    // Excluded from the legend if not drawn.
    if (std::find(views.begin(), views.end(), ViewKind::kCamera) == views.end()) {
      result.layers.camera.reset();
    }
  }
  return result;
}

}  // namespace

std::vector<ViewKind> viewsNamed(const std::string& view) {
  const std::string list = view == "both"  ? "top+driver"
                           : view == "all" ? "top+driver+camera"
                                           : view;
  std::vector<ViewKind> views;
  std::size_t from = 0;
  while (from <= list.size()) {
    const std::size_t to = std::min(list.find('+', from), list.size());
    const std::string name = list.substr(from, to - from);
    const auto named = std::find_if(std::begin(kViews), std::end(kViews),
                                    [&](const auto& row) { return name == row.name; });
    if (named == std::end(kViews)) {
      throw Error(ExitCode::kUsage, fmt::format("--view {}: expected top, driver, camera joined by "
                                                "+, both or all",
                                                view));
    }
    views.push_back(named->kind);
    from = to + 1;
  }
  return views;
}

std::vector<SceneView> viewsOfRuns(const std::vector<ShownRun>& runs, std::size_t index,
                                   const GroundTruth* truth, const std::vector<ViewKind>& views) {
  const Stamp stamp = runs[0].run.scenes[index].stamp;
  std::vector<SceneView> result;
  for (const ShownRun& shown : runs) {
    std::size_t nearest = index;
    if (&shown != &runs[0]) {
      nearest = nearestScene(shown.run, stamp);
      if (std::abs(shown.run.scenes[nearest].stamp - stamp) > kNearestScene) {
        throw DataError(fmt::format("{}: no scene at the times of {}: not of the same log?",
                                    shown.run.dir, runs[0].run.dir));
      }
    }
    result.push_back(viewOf(shown, nearest, truth, views));
  }
  return result;
}

}  // namespace perception
