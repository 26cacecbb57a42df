#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/calibration/clusters/ClusterSamples.h"
#include "libperception/lidar/classification/ClusterClassifier.h"

namespace perception {

/// A log of the training.
struct TrainingLog {
  std::string name;
  bool simulated = false;
};

/// Learns classifiers of clusters from the samples of several logs. Samples count so that every log
/// has the same say in each kind (as if of at most 400 samples), kinds by the root of their number,
/// and simulated logs, beside recorded ones, for three tenths (method.md 8.10).
class ClusterTrainer {
 public:
  /// Borrows both.
  ClusterTrainer(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                 std::uint64_t seed);

  /// Raw probabilities of all samples of a log, by trees that have seen neither it nor `without`.
  /// Kept for the next call.
  using Probabilities = std::array<double, kClusterKinds>;
  const std::vector<Probabilities>& leftOut(std::size_t log, std::size_t without);

  /// A classifier of all logs but `without` (logs().size(): of all). Calibrated on the
  /// probabilities that trees without the very log give: those of recordings where there are any.
  /// P(phantom) stays as it is then: how many there are is a matter of the weather of the log.
  ClusterClassifier classifier(std::size_t without, Provenance provenance);

  /// Samples of a log, as indices.
  const std::vector<std::size_t>& of(std::size_t log) const { return of_log_[log]; }
  std::size_t logs() const { return logs_.size(); }

 private:
  BoostedTrees train(std::size_t without, std::size_t without_too) const;
  EvidenceMemory memoryOf(const ClusterClassifier& shape, std::size_t without);

  const ClusterSamples& samples_;
  const std::vector<TrainingLog>& logs_;
  const std::uint64_t seed_;
  bool recorded_ = false;  ///< some log is no simulation
  std::vector<std::vector<std::size_t>> of_log_;
  std::vector<std::vector<std::vector<Probabilities>>> left_out_;  ///< [log][without][sample]
};

/// How the errors of evidence repeat over the views of one object, by least squares of the products
/// of its errors in two views (those of samples `of`, at most 4 s apart), shape on a grid. Defaults
/// where fewer than 200 pairs of views are known.
EvidenceMemory fitMemory(const ClusterSamples& samples, const std::vector<std::size_t>& of,
                         std::vector<double> evidence);

}  // namespace perception
