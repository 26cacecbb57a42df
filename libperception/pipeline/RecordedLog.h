#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/scene/SceneFromPosterior.h"
#include "libperception/scene/TrackedRun.h"

namespace perception {

/// What a log's front ends hand to the filter, and when scenes are taken, in order: so that a log
/// is read and seen once and tracked in many ways.
struct RecordedLog {
  struct Entry {
    enum Kind { kScan, kScene, kRestart } kind = kScan;
    std::shared_ptr<const MeasurementScan> scan;  ///< kScan
    EgoState ego;                                 ///< kScene
    std::int64_t frame = -1;                      ///< kScene
  };
  std::string name;  ///< of the log
  bool simulated = false;
  Stamp first_stamp;  ///< t = 0
  FilterModel model;
  ParticleFilterParams particles;
  SceneParams scene;
  std::vector<Entry> entries;
};

/// A way to track a recorded log.
struct ReplayMethod {
  Proposal proposal = Proposal::kSampled;
  int particles = 8;
  std::uint64_t seed = 1;
  bool drawn_births = false;  ///< DUC's: birth or clutter is drawn, existence fades in 3 s
};

/// The scenes that perception-track makes of the log with these settings.
TrackedRun replay(const RecordedLog& log, const ReplayMethod& method);

/// Births of the tracker of the DARPA Urban Challenge (method.md 5.1, 5.9).
void setDrawnBirths(FilterParams& params);

}  // namespace perception
