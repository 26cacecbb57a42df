#include "libperception/pipeline/input/RecordedLog.h"

#include <tbb/task_arena.h>

namespace perception {

void setDrawnBirths(FilterParams& params) {
  params.sampled_births = true;
  params.existence_decay = 3;   // [s] method.md 5.1: T95
  params.existence_min = 0.05;  // method.md 5.9
}

TrackedRun replay(const RecordedLog& log, const ReplayMethod& method) {
  FilterModel model = log.model;
  model.proposal = method.proposal;
  if (method.drawn_births) setDrawnBirths(model.params);
  ParticleFilterParams particles = log.particles;
  particles.sample_size = method.particles;
  CRbpfTracker tracker(model, particles.toMrpt(), method.seed);
  SceneFromPosterior scenes(model, log.scene);
  TrackedRun run;
  run.dir = log.name;
  run.first_stamp = log.first_stamp;
  run.class_names = model.classes.names();
  for (const RecordedLog::Entry& entry : log.entries) {
    switch (entry.kind) {
      case RecordedLog::Entry::kScan:
        // A waiting thread must not start another replay: MRPT resamples with the thread's
        // generator, seeded before the scan.
        tbb::this_task_arena::isolate([&] { tracker.process(*entry.scan); });
        break;
      case RecordedLog::Entry::kScene:
        run.scenes.push_back(scenes.make(tracker.mapHypothesis(), entry.ego, entry.frame));
        break;
      case RecordedLog::Entry::kRestart:
        tracker.reset();
        break;
    }
  }
  return run;
}

}  // namespace perception
