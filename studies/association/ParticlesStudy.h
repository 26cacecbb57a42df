#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "studies/association/EncounterRuns.h"

namespace perception {

/// Errors over the number of particles on a simulated busy street, with sampled births (DUC) and
/// with Bernoulli newborns (second particle study of [radecki2016]).
struct ParticlesParams {
  int scenes = 40;
};

/// Filter settings.
struct ParticlesMethod {
  std::string label;
  Proposal proposal = Proposal::kSampled;
  bool duc = false;  ///< sampled births, existence decays in 3 s
  int particles = 8;
  std::uint64_t filter_seed = 1;
};

struct ParticlesFigures {
  double count_rms = 0, classified_rms = 0;  ///< against the same births with 50 particles
  double truth_rms = 0;                      ///< number of outputs against objects in view
  double gospa = 0;                          ///< [m]
  double mean_count = 0, mean_classified = 0;
  std::vector<double> error_cdf;  ///< share of instants with an error of at most i objects
};

/// One run per scene.
std::vector<EncounterScore> runParticles(const ParticlesMethod& method, int scenes);
ParticlesFigures compareParticles(const std::vector<EncounterScore>& runs,
                                  const std::vector<EncounterScore>& reference);

StudyReport particlesStudy(const ParticlesParams& params);

}  // namespace perception
