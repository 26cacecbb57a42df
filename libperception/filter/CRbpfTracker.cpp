#include "libperception/filter/CRbpfTracker.h"

#include <mrpt/random/RandomGenerators.h>

#include <cassert>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/math/LogMath.h"

namespace perception {
namespace {

enum ResamplingPurpose : std::uint32_t { kResampling = 0x5703 };

}  // namespace

void ParticleFilterParams::visit(ParamVisitor& v) {
  v.choice(
      "PF_algorithm", pf_algorithm,
      {"pfStandardProposal", "pfAuxiliaryPFStandard", "pfOptimalProposal", "pfAuxiliaryPFOptimal"},
      "MRPT's name; this filter implements pfOptimalProposal only");
  v.require(pf_algorithm == 2, "PF_algorithm: this filter implements pfOptimalProposal only");
  v.choice("resamplingMethod", resampling_method,
           {"prMultinomial", "prResidual", "prStratified", "prSystematic"}, "MRPT's name");
  v.real("BETA", beta, {0, 1}, "", "resample when ESS / sampleSize falls below it");
  v.integer("sampleSize", sample_size, {1, 65536}, "number of particles");
}

mrpt::bayes::CParticleFilter::TParticleFilterOptions ParticleFilterParams::toMrpt() const {
  using PF = mrpt::bayes::CParticleFilter;
  PF::TParticleFilterOptions options;
  options.PF_algorithm = static_cast<PF::TParticleFilterAlgorithm>(pf_algorithm);
  options.resamplingMethod = static_cast<PF::TParticleResamplingAlgorithm>(resampling_method);
  options.BETA = beta;
  options.sampleSize = static_cast<unsigned>(sample_size);
  options.adaptiveSampleSize = false;
  return options;
}

CRbpfTracker::CRbpfTracker(FilterModel model, const Options& options, std::uint64_t seed)
    : model_(std::move(model)), slots_(std::max(1u, options.sampleSize)), seed_(seed) {
  if (options.PF_algorithm != mrpt::bayes::CParticleFilter::pfOptimalProposal) {
    throw ConfigError("PF_algorithm: this filter implements pfOptimalProposal only");
  }
  if (model_.params.sampled_births && model_.proposal != Proposal::kSampled)
    throw ConfigError("[filter] sampled_births: needs [run] association = sampled");
  executor_.m_options = options;
  if (model_.proposal != Proposal::kSampled) executor_.m_options.BETA = 0;
  reset();
}

bool CRbpfTracker::process(const MeasurementScan& scan) {
  if (started_ && scan.state.stamp < stamp_) return false;
  // MRPT resamples with this thread's generator; assignment also clears the cached normal deviate,
  // which randomize() keeps.
  if (executor_.m_options.BETA > 0) {
    Rng seeds({seed_, scans_, 0, kResampling});
    mrpt::random::getRandomGenerator() = mrpt::random::CRandomGenerator(seeds());
  }
  scan_ = &scan;
  mrpt::bayes::CParticleFilter::TParticleFilterStats pf_stats;
  executor_.executeOn(*this, nullptr, nullptr, &pf_stats);
  scan_ = nullptr;
  stats_.ess = pf_stats.ESS_beforeResample;
  stats_.resampled = pf_stats.ESS_beforeResample < executor_.m_options.BETA;
  stamp_ = scan.state.stamp;
  ++scans_;
  started_ = true;
  return true;
}

void CRbpfTracker::reset() {
  setPosterior(Posterior::empty(model_.proposal == Proposal::kSampled ? slots_ : 1));
  map_ = std::make_shared<const Hypothesis>();
  history_.clear();
  started_ = false;
}

void CRbpfTracker::prediction_and_update_pfOptimalProposal(const mrpt::obs::CActionCollection*,
                                                           const mrpt::obs::CSensoryFrame*,
                                                           const Options&) {
  if (!scan_)
    throw Error(ExitCode::kInternal, "CRbpfTracker: executed without a scan; use process()");
  Posterior before;
  before.hypotheses.reserve(m_particles.size());
  before.log_weights.reserve(m_particles.size());
  for (auto& p : m_particles) {
    before.hypotheses.push_back(std::move(p.d));
    before.log_weights.push_back(p.log_w);
  }
  StepResult result = step(before, *scan_, model_, {seed_, scans_, 0, 0}, slots_);
  const MapHypothesis best = perception::mapHypothesis(result.posterior);
  map_ = result.posterior.hypotheses[best.slot];
  static_cast<StepStats&>(stats_) = result.stats;
  stats_.hypotheses = best.distinct;
  stats_.map_probability = best.probability;
  if (model_.history > 0) keepHistory(result.posterior, scan_->state.stamp);
  setPosterior(std::move(result.posterior));
}

void CRbpfTracker::keepHistory(const Posterior& posterior, Stamp now) {
  history_.emplace_back(now, posterior.hypotheses);
  // Keeps one entry before the span, since the instants in it lie between two scans.
  while (history_.size() > 1 && now - history_[1].first >= model_.history) history_.pop_front();
}

void CRbpfTracker::setPosterior(Posterior&& posterior) {
  m_particles.resize(posterior.hypotheses.size());
  for (std::size_t i = 0; i < m_particles.size(); ++i) {
    m_particles[i].d = std::move(posterior.hypotheses[i]);
    const double w = posterior.log_weights[i];
    // With NaN weights MRPT neither resamples nor reports an error.
    m_particles[i].log_w = std::isfinite(w) ? w : -1e300;
  }
}

void CRbpfTracker::performSubstitution(const std::vector<size_t>& indices) {
  CParticleFilterDataImpl::performSubstitution(indices);
  for (auto& p : m_particles) p.log_w = 0;
}

}  // namespace perception
