#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gui-offscreen/html/ObjectLives.h"
#include "gui-offscreen/html/RunParts.h"
#include "libperception/core/system/SpoolFile.h"
#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRunReader.h"

namespace perception {

/// Contents of the page of a run; empty parts are omitted.
struct ReportContent {
  /// An embedded picture or video.
  struct Figure {
    std::string title, caption;
    std::string media_type;  ///< "image/png", "video/mp4"
    std::string file;        ///< its path
  };
  RunOutline run;
  RunRecord record;
  std::string id;               ///< of the run, as its products carry it
  double real_time_factor = 0;  ///< 0: unknown
  nlohmann::json phantoms;      ///< events of phantoms as an array, or null
  nlohmann::json evaluation;    ///< report.json of perception-evaluate, or null
  std::vector<Figure> video;    ///< at most one
  std::vector<Figure> pictures, plots;
  std::vector<ObjectLife> lives;    ///< of all objects, by id
  std::unique_ptr<RunParts> parts;  ///< named "run"; null: no view of the run
};

/// Writes a self-contained HTML page: inputs of a run, tracked objects over time, comparison with
/// the truth.
void writeHtmlPage(const ReportContent& content, const TextSink& sink);

}  // namespace perception
