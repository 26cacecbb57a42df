#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/simulation/world/EncounterScenes.h"
#include "studies/association/EncounterRuns.h"

namespace perception {

/// Identity swaps and GOSPA of association methods in simulated encounters, one configuration for
/// all.
struct AssociationParams {
  int seeds = 400;  ///< scenes 1 ... seeds
};

/// A scene of the study.
struct AssociationScene {
  std::string label, scene;
  EncounterConditions conditions;
};
const std::vector<AssociationScene>& associationScenes();

/// Association method and number of particles or hypotheses.
struct AssociationMethod {
  std::string label;
  Proposal proposal = Proposal::kSampled;
  int particles = 8;
};

/// Filter model of the study: two pedestrian motion modes, no pruning except the gate.
FilterModel associationModel(Proposal proposal);

struct AssociationFigures {
  int runs = 0, swaps = 0;
  double gospa = 0, tracked = 0;  ///< means over runs
};
AssociationFigures runAssociation(const AssociationScene& scene, const AssociationMethod& method,
                                  int seeds);

StudyReport associationStudy(const AssociationParams& params);

}  // namespace perception
