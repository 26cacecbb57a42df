#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libperception/scene/files/RunRecord.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// Contents of the page of a run; empty parts are omitted.
struct ReportContent {
  /// An embedded picture or video.
  struct Figure {
    std::string title, caption;
    std::string media_type;  ///< "image/png", "video/mp4"
    std::string bytes;       ///< of the file
  };
  const TrackedRun* run = nullptr;
  RunRecord record;
  std::string id;               ///< of the run, as its products carry it
  double real_time_factor = 0;  ///< 0: unknown
  nlohmann::json events;        ///< events.jsonl as an array, or null
  nlohmann::json evaluation;    ///< report.json of perception-evaluate, or null
  std::vector<Figure> video;    ///< at most one
  std::vector<Figure> pictures, plots;
  std::string data;  ///< RunData::html("run")
};

/// A self-contained HTML page: inputs of a run, tracked objects over time, comparison with the
/// truth.
std::string htmlPage(const ReportContent& content);

}  // namespace perception
