#pragma once
#include <mrpt/bayes/CParticleFilter.h>
#include <mrpt/bayes/CParticleFilterData.h>

#include <deque>
#include <utility>
#include <vector>

#include "libperception/config/ParamSet.h"
#include "libperception/filter/Step.h"

namespace perception {

/// [particle_filter]: MRPT's TParticleFilterOptions by their own names.
struct ParticleFilterParams {
  int pf_algorithm = 2;  ///< index into names(): only pfOptimalProposal is implemented
  int resampling_method =
      3;  ///< MRPT's order: prMultinomial, prResidual, prStratified, prSystematic
  double beta =
      0.5;  ///< resample when the effective share of particles falls below it (method.md 5.10)
  int sample_size = 8;  ///< number of particles; 8 as in [radecki2016]

  void visit(ParamVisitor& v);
  mrpt::bayes::CParticleFilter::TParticleFilterOptions toMrpt() const;
};

/// What one scan did to the particle set.
struct ScanStats : StepStats {
  double ess = 1;  ///< effective share of particles before resampling, in (0, 1]
  bool resampled = false;
  double map_probability = 0;  ///< of the hypothesis that is output
};

/// The joint association, tracking and classification filter as an MRPT particle-filter algorithm:
/// particles are handles of hypotheses, the proposal is the optimal one, executed and resampled by
/// mrpt::bayes::CParticleFilter. With ranked associations it holds at most sampleSize distinct
/// hypotheses and is never resampled (BETA = 0): one dominant hypothesis is no degeneracy there.
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

  /// One scan through CParticleFilter::executeOn(). Scans must come in order of time; an older one
  /// is refused (false).
  bool process(const MeasurementScan& scan);
  /// Forgets every track, as after a jump of the clock; new tracks get new identities.
  void reset();

  const FilterModel& model() const { return model_; }
  const ScanStats& stats() const { return stats_; }
  /// The most probable hypothesis after the last scan, taken before resampling.
  const Hypothesis& mapHypothesis() const { return *map_; }
  Stamp stamp() const { return stamp_; }
  std::uint64_t scans() const { return scans_; }

  /// MRPT 2.5.8 keeps the old weights after resampling; they are reset here.
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
  bool started_ = false;  ///< stamp_ is that of a scan since the last reset
  Stamp stamp_;
  const MeasurementScan* scan_ = nullptr;  ///< the scan that executeOn() is to use
  HypothesisHandle map_;
  /// What the particles held after the scans of the last FilterModel::history seconds: keeps alive
  /// what tracks are linked to.
  std::deque<std::pair<Stamp, std::vector<HypothesisHandle>>> history_;
  ScanStats stats_;
};

}  // namespace perception
