#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "libperception/evaluation/without_truth/Quality.h"

namespace perception {

// The parts of qualityOf(): what is summed over a run's samples, tracks, innovations and seeds.

/// What counts: objects of named classes in a sector about the vehicle.
class QualitySector {
 public:
  QualitySector(const TrackedRun& run, const QualityOptions& options);
  bool named(const SceneObject& object) const {
    return named_[static_cast<std::size_t>(object.class_id)];
  }
  bool holds(const Scene& scene, const SceneObject& object, bool away_from_border = false) const;

 private:
  const QualityOptions& options_;
  std::vector<bool> named_;
};

/// An output of a track.
struct QualitySample {
  double t = 0;  ///< [s]
  const SceneObject* object = nullptr;
  bool inside = false;  ///< of the sector, away from its border
  int modalities = 0;   ///< that hit it lately
};
using QualitySamples = std::map<std::uint64_t, std::vector<QualitySample>>;

/// A mean, or the root of a mean square.
struct QualityMean {
  double sum = 0;
  std::size_t count = 0;
  void add(double x) { sum += x, ++count; }
  Figure value() const { return count > 0 ? Figure(sum / static_cast<double>(count)) : Figure(); }
  Figure root() const { return count > 0 ? Figure(std::sqrt(*value())) : Figure(); }
};

/// By id, in order of time.
QualitySamples samplesOf(const TrackedRun& run, const QualitySector& sector);

/// Sums over the samples of all tracks.
struct SampleFigures {
  QualityMean curve, velocity, unsure;
  double doubt = 0;  ///< sum
  Figure alone;      ///< outputs; empty with one kind of sensor
  double seconds = 0;
  std::size_t flips = 0;
};

SampleFigures sampleFigures(const QualitySamples& tracks, bool several_modalities,
                            std::vector<QualityMoment>& moments);

/// Counts over the tracks.
struct TrackFigures {
  std::size_t short_lives = 0;
  std::size_t sudden = 0, ends = 0;  ///< beginnings and ends away from the border
  std::size_t handovers = 0;
};

/// `first`, `last`: of the run's scenes [s].
TrackFigures trackFigures(const QualitySamples& tracks, double first, double last,
                          std::vector<QualityMoment>& moments);

/// Of innovations.csv in the run's folder; empty without it.
struct InnovationFigures {
  Figure off;   ///< |log2 of NIS per axis|
  Figure lag1;  ///< [-]
};

InnovationFigures innovationFigures(const TrackedRun& run, const QualityOptions& options);

/// A run against those that differ by their seed.
struct SeedFigures {
  QualityMean alone;     ///< outputs of the run that the other one does not have, an instant
  QualityMean distance;  ///< [m^2] squared, of those that it has

  void add(const TrackedRun& run, const TrackedRun& sibling, const QualitySector& sector);
};

}  // namespace perception
