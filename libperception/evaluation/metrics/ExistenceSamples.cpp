#include "libperception/evaluation/metrics/ExistenceSamples.h"

namespace perception {

std::vector<ExistenceSample> existenceSamples(const std::vector<SeenEstimate>& named,
                                              const std::vector<SeenTruth>& truth,
                                              const EvaluationOptions& options,
                                              std::size_t instant) {
  std::vector<ExistenceSample> samples;
  std::vector<bool> real(named.size(), false), served(truth.size(), false);
  const auto pairs = match(centers(truth), centers(named), options.tolerance, Pairing::kOneToOne);
  for (std::size_t t = 0; t < pairs.size(); ++t) {
    if (pairs[t] < 0) continue;
    real[static_cast<std::size_t>(pairs[t])] = true;
    served[t] = true;
  }
  for (std::size_t i = 0; i < named.size(); ++i) {
    bool unclear = false;
    for (std::size_t t = 0; t < truth.size() && !real[i]; ++t) {
      const Vector2& center = named[i].footprint.center;
      const bool twice = served[t] && isNear(truth[t], center, options.tolerance);
      unclear = unclear || (isNear(truth[t], center, options.exclusion) && !twice);
    }
    if (unclear) continue;
    samples.push_back({instant, named[i].object->existence, static_cast<bool>(real[i])});
  }
  return samples;
}

}  // namespace perception
