#include "libperception/core/Error.h"
#include "libperception/evaluation/metrics/Evaluation.h"

namespace perception {
namespace {

// Truth ids are made unique over the runs.
constexpr std::int64_t kIdsOfARun = 1000000;
constexpr std::uint64_t kTracksOfARun = 1'000'000'000;

}  // namespace

Evaluation pooled(const std::vector<const Evaluation*>& parts) {
  Evaluation sum;
  std::int64_t run = 0;
  for (const Evaluation* part : parts) {
    if (run == 0) {
      sum.class_names = part->class_names;
      sum.named = part->named;
      sum.sensors = part->sensors;
    } else if (part->class_names != sum.class_names || part->named != sum.named) {
      throw DataError("runs with different classes cannot be pooled");
    }
    const std::size_t first = sum.instants.size();
    for (InstantFigures instant : part->instants) {
      for (auto& id : instant.identities.truth)
        if (id >= 0) id = run * kIdsOfARun + id % kIdsOfARun;
      for (auto& id : instant.identities.estimates)
        id += static_cast<std::uint64_t>(run) * kTracksOfARun;
      sum.instants.push_back(std::move(instant));
    }
    for (TruthSample sample : part->samples) {
      sample.instant += first;
      if (sample.id >= 0) sample.id = run * kIdsOfARun + sample.id % kIdsOfARun;
      sum.samples.push_back(std::move(sample));
    }
    for (ExistenceSample sample : part->existence) {
      sample.instant += first;
      sum.existence.push_back(sample);
    }
    sum.alignment.by_frame += part->alignment.by_frame;
    sum.alignment.by_time += part->alignment.by_time;
    sum.alignment.assumed_empty += part->alignment.assumed_empty;
    sum.alignment.scenes_without_truth += part->alignment.scenes_without_truth;
    sum.alignment.truth_without_scene += part->alignment.truth_without_scene;
    for (std::size_t u = 0; u < sum.truth_use.size(); ++u) sum.truth_use[u] += part->truth_use[u];
    ++run;
  }
  return sum;
}

}  // namespace perception
