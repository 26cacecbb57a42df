#pragma once
#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/bayes/CParticleFilterData.h>

#include <deque>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/filter/Step.h"

namespace perception {

/// [particle_filter]: MRPT's TParticleFilterOptions, keys named as in MRPT.
struct ParticleFilterParams {
  int pf_algorithm = 2;       ///< MRPT's TParticleFilterAlgorithm; only pfOptimalProposal (2) is
                              ///< implemented (method.md 5.4)
  int resampling_method = 3;  ///< MRPT's TParticleResamplingAlgorithm: 0 prMultinomial ... 3
                              ///< prSystematic (method.md 5.10)
  double beta = 0.5;          ///< resampling threshold on ESS / sampleSize (method.md 5.10)
  int sample_size = 8;        ///< number of particles [radecki2016]

  void visit(ParamVisitor& v);
  mrpt::bayes::CParticleFilter::TParticleFilterOptions toMrpt() const;
};

/// Statistics of the particle set for one scan.
struct ScanStats : StepStats {
  double ess = 1;  ///< effective sample size / sampleSize before resampling, in (0, 1]
  bool resampled = false;
  double map_probability = 0;  ///< posterior probability of mapHypothesis()
};

/// The joint association, tracking and classification filter as an MRPT particle-filter algorithm:
/// particles are shared pointers to hypotheses, the proposal is the optimal one, executed and
/// resampled by mrpt::bayes::CParticleFilter. With ranked associations it holds at most sampleSize
/// distinct hypotheses and is never resampled (BETA = 0): there, one hypothesis of dominant weight
/// does not indicate degeneracy.
class CRbpfTracker final
    : public mrpt::bayes::CParticleFilterData<HypothesisHandle,
                                              mrpt::bayes::particle_storage_mode::VALUE>,
      public mrpt::bayes::CParticleFilterDataImpl<
          CRbpfTracker,
          mrpt::bayes::CParticleFilterData<
              HypothesisHandle, mrpt::bayes::particle_storage_mode::VALUE>::CParticleList> {
 public:
  using Options = mrpt::bayes::CParticleFilter::TParticleFilterOptions;

  CRbpfTracker(FilterModel model, const Options& options, std::uint64_t seed);

  /// Processes one scan by CParticleFilter::executeOn(). Scans must be in chronological order;
  /// returns false, with the state unchanged, for a scan older than the last one.
  bool process(const MeasurementScan& scan);
  /// Deletes all tracks, as after a clock jump. Tracks born later get new ids.
  void reset();

  const FilterModel& model() const { return model_; }
  const ScanStats& stats() const { return stats_; }
  /// The most probable hypothesis after the last scan, taken before resampling.
  const Hypothesis& mapHypothesis() const { return *map_; }
  Stamp stamp() const { return stamp_; }
  std::uint64_t scans() const { return scans_; }

  /// Also sets all weights equal: MRPT 2.5.8 keeps the old weights after resampling.
  void performSubstitution(const std::vector<size_t>& indices) override;

 protected:
  void prediction_and_update_pfOptimalProposal(const mrpt::obs::CActionCollection* action,
                                               const mrpt::obs::CSensoryFrame* observation,
                                               const Options& options) override;

 private:
  void setPosterior(Posterior&& posterior);
  void keepHistory(const Posterior& posterior, Stamp now);

  FilterModel model_;
  mrpt::bayes::CParticleFilter executor_;
  std::size_t slots_;  ///< sampleSize
  std::uint64_t seed_;
  std::uint64_t scans_ = 0;
  bool started_ = false;  ///< at least one scan was processed since the last reset()
  Stamp stamp_;
  const MeasurementScan* scan_ = nullptr;  ///< input of the executeOn() call in progress
  HypothesisHandle map_;
  /// Hypotheses of the particles after each scan of the last FilterModel::history seconds: owns the
  /// tracks that Track::previous points to.
  std::deque<std::pair<Stamp, std::vector<HypothesisHandle>>> history_;
  ScanStats stats_;
};

}  // namespace perception
