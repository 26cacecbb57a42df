#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libperception/scene/RunRecord.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// All that the page of a run tells. What is empty is left out.
struct ReportContent {
  /// A picture or film of the page, inside of it.
  struct Figure {
    std::string title, caption;
    std::string media_type;  ///< "image/png", "video/mp4"
    std::string bytes;       ///< of the file
  };
  const TrackedRun* run = nullptr;
  RunRecord record;
  double real_time_factor = 0;  ///< 0: unknown
  nlohmann::json evaluation;    ///< report.json of perception-evaluate, or null
  std::vector<Figure> video;    ///< at most one
  std::vector<Figure> pictures, plots;
};

/// One HTML page, whole in itself: no network, no other file. Says what a run was made of, what it
/// tracked and when, and how that compares with the truth.
std::string htmlPage(const ReportContent& content);

}  // namespace perception
