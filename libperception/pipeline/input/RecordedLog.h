#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/scene/SceneFromPosterior.h"
#include "libperception/scene/files/TrackedRun.h"

namespace perception {

/// The scans of a log and the instants of its scenes in order, so that a log is decoded once and
/// tracked with several methods.
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

/// Filter settings of a replay.
struct ReplayMethod {
  Proposal proposal = Proposal::kSampled;
  int particles = 8;
  std::uint64_t seed = 1;
  bool drawn_births = false;  ///< as in DUC: birth or clutter is sampled, existence decays in 3 s
};

/// The same scenes as perception-track with these settings.
TrackedRun replay(const RecordedLog& log, const ReplayMethod& method);

/// Births of the tracker of the DARPA Urban Challenge (method.md 5.1, 5.9).
void setDrawnBirths(FilterParams& params);

}  // namespace perception
