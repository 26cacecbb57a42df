#include "libperception/filter/CRbpfTracker.h"

#include <mrpt/random/RandomGenerators.h>

#include <cassert>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/core/LogMath.h"

namespace perception {
namespace {

enum Purpose : std::uint32_t { kResampling = 0x5703 };

}  // namespace

void ParticleFilterParams::visit(ParamVisitor& v) {
  v.choice(
      "PF_algorithm", pf_algorithm,
      {"pfStandardProposal", "pfAuxiliaryPFStandard", "pfOptimalProposal", "pfAuxiliaryPFOptimal"},
      "MRPT's name; pfOptimalProposal is the one that this filter implements");
  v.require(pf_algorithm == 2, "PF_algorithm: this filter implements pfOptimalProposal only");
  v.choice("resamplingMethod", resampling_method,
           {"prMultinomial", "prResidual", "prStratified", "prSystematic"}, "MRPT's name");
  v.real("BETA", beta, {0, 1}, "", "resample when the effective share of particles falls below it");
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
    : model_(std::move(model)), seed_(seed) {
  if (options.PF_algorithm != mrpt::bayes::CParticleFilter::pfOptimalProposal) {
    throw ConfigError("PF_algorithm: this filter implements pfOptimalProposal only");
  }
  executor_.m_options = options;
  m_particles.resize(std::max(1u, options.sampleSize));
  for (auto& p : m_particles) p.log_w = 0;
}

bool CRbpfTracker::process(const MeasurementScan& scan) {
  if (started_ && scan.state.stamp < stamp_) return false;
  // MRPT resamples with this thread's generator; assignment also clears what randomize() would
  // leave behind.
  Rng seeds({seed_, scans_, 0, kResampling});
  mrpt::random::getRandomGenerator() = mrpt::random::CRandomGenerator(seeds());
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
  for (auto& p : m_particles) {
    p.d.tracks.clear();
    p.log_w = 0;
  }
  map_.tracks.clear();
  started_ = false;
}

void CRbpfTracker::prediction_and_update_pfOptimalProposal(const mrpt::obs::CActionCollection*,
                                                           const mrpt::obs::CSensoryFrame*,
                                                           const Options&) {
  if (!scan_)
    throw Error(ExitCode::kInternal, "CRbpfTracker: executed without a scan; use process()");
  std::vector<Hypothesis> before;
  before.reserve(m_particles.size());
  for (auto& p : m_particles) before.push_back(std::move(p.d));
  StepResult result = step(before, *scan_, model_, {seed_, scans_, 0, 0});
  std::vector<const Hypothesis*> after;
  std::vector<double> log_weights;
  for (std::size_t i = 0; i < m_particles.size(); ++i) {
    auto& p = m_particles[i];
    p.d = std::move(result.hypotheses[i]);
    p.log_w += result.log_weights[i];
    if (!std::isfinite(p.log_w))
      p.log_w = -1e300;  // MRPT turns a NaN into silence (no resampling, no error)
    after.push_back(&p.d);
    log_weights.push_back(p.log_w);
  }
  const MapHypothesis best = perception::mapHypothesis(after, log_weights);
  map_ = *after[best.slot];
  static_cast<StepStats&>(stats_) = result.stats;
  stats_.hypotheses = best.distinct;
  stats_.map_probability = best.probability;
}

void CRbpfTracker::performSubstitution(const std::vector<size_t>& indices) {
  CParticleFilterDataImpl::performSubstitution(indices);
  for (auto& p : m_particles) p.log_w = 0;
}

}  // namespace perception
