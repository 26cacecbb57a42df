#include "libperception/pictures/pages/SnapshotWriter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "gui-offscreen/views/ContactSheet.h"
#include "gui-offscreen/views/SceneFile.h"
#include "gui-offscreen/views/VideoFile.h"
#include "libperception/grid/CGridExport.h"
#include "libperception/pictures/RunScenes.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/scene/files/OutputFile.h"
#include "libperception/scene/files/RunMark.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSheetTiles = 36;  // on the contact sheet of pictures at intervals
constexpr double kSlowestFilm = 1;       // [s] a picture at most

}  // namespace

std::vector<SceneView> SnapshotWriter::viewsOf(std::size_t index) const {
  auto views = viewsOfRuns(shown_, index, truth_, options_.params.views);
  for (SceneView& shown : views) shown.layers.thing_ids = options_.details;
  return views;
}

std::string SnapshotWriter::fileFor(const SceneView& shown, const std::string& output) const {
  if (options_.every <= 0) return output;
  const auto ms = static_cast<long long>(std::llround(shown.t * 1000));
  return (fs::path(output) / fmt::format("t{:09d}ms.png", ms)).string();
}

void SnapshotWriter::write(const std::string& path, Picture picture) {
  writePicture(path, picture, mark_);
  last_ = std::move(picture);
  on_file(path, path);
}

void SnapshotWriter::drawPictures(const std::vector<std::size_t>& chosen,
                                  const std::string& output) {
  const bool sheet = options_.contact > 0 || (options_.every > 0 && shown_.size() == 1);
  const std::vector<std::size_t> on_sheet =
      !sheet ? std::vector<std::size_t>{}
             : spread(chosen, options_.contact > 0 ? chosen.size() : kSheetTiles);
  createFolder(options_.every > 0 ? output : fs::path(output).parent_path().string());
  Snapshot snapshot(options_.params);
  std::vector<Picture> tiles;
  std::vector<SceneView> views;
  Progress progress("drawing", chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    stopIfAsked();
    views = viewsOf(chosen[i]);
    if (options_.contact == 0) {
      write(fileFor(views[0], output), snapshot.picture(views));
      if (snapshot.labelsLeftOut() > 0) {
        on_note(fmt::format("t = {:.2f} s: no room for {} labels", views[0].t,
                            snapshot.labelsLeftOut()));
      }
    }
    if (std::binary_search(on_sheet.begin(), on_sheet.end(), chosen[i])) {
      tiles.push_back(snapshot.tile(views[0]));
    }
    progress.update(i + 1, i + 1);
  }
  if (!tiles.empty()) {
    const std::string path =
        options_.every > 0 ? (fs::path(output) / "contact.png").string() : output;
    write(path, contactSheet(tiles, views[0]));
  }
  if (!options_.scene_file.empty()) {
    createFolder(fs::path(options_.scene_file).parent_path().string());
    writeSceneFile(options_.scene_file, views[0], options_.params.range, mark_);
    on_file(options_.scene_file, options_.scene_file);
  }
  for (const std::string& file : options_.grid_files) {
    createFolder(fs::path(file).parent_path().string());
    writeFile(file, withMark(gridFileOf(shown_[0].sensors->grid(), file), mark_));
    on_file(file, file);
  }
}

// Real time: frame rate by the median scene interval; in gaps of the log the video shows the last
// scene.
void SnapshotWriter::drawVideo(const std::vector<std::size_t>& chosen, const std::string& video) {
  const auto& scenes = shown_[0].run.scenes;
  const auto at = [&](std::size_t i) { return scenes[chosen[i]].stamp - scenes[chosen[0]].stamp; };
  std::vector<double> gaps;
  for (std::size_t i = 1; i < chosen.size(); ++i) gaps.push_back(at(i) - at(i - 1));
  std::sort(gaps.begin(), gaps.end());
  const double gap =
      gaps.empty() ? kSlowestFilm : std::clamp(gaps[gaps.size() / 2], 1e-2, kSlowestFilm);
  createFolder(fs::path(video).parent_path().string());
  VideoFile film(video, 1 / gap, mark_);
  Snapshot snapshot(options_.params);
  Progress progress("filming", chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    stopIfAsked();
    last_ = snapshot.picture(viewsOf(chosen[i]));
    const double until = i + 1 < chosen.size() ? at(i + 1) : at(i) + gap;
    do {
      film.add(last_);
    } while (static_cast<double>(film.frames()) * gap < until - gap / 2);
    progress.update(i + 1, i + 1);
  }
  film.close();
  on_file(fmt::format("{}: {} frames, {:.2f} a second", video, film.frames(), 1 / gap), video);
}

}  // namespace perception
