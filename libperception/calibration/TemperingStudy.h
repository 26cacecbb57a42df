#pragma once
#include <vector>

#include "libperception/calibration/TemperedLog.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/metrics/Evaluation.h"
#include "libperception/evaluation/tables/StudyReport.h"

namespace perception {

/// Maximum-likelihood estimation of tempering exponents from the true classes.
struct TemperingParams {
  Proposal proposal = Proposal::kRanked;
  int particles = 8;
  std::uint64_t seed = 1;
  int rounds = 2;                ///< of the optimizer, see kEvaluationsARound (assumed)
  EvaluationOptions evaluation;  ///< sector in which truth counts
};

/// A log with its truth.
struct TemperingLog {
  RecordedLog log;
  GroundTruth truth;
};

/// Calibration of the class posterior.
struct ClassCalibration {
  double log_likelihood = 0;      ///< mean of log P(true class) over tracked objects and instants
  double ece = 0;                 ///< expected calibration error of the likeliest class
  double correct = 0, wrong = 0;  ///< shares classified as the true class, as another one
  std::size_t samples = 0;
};
ClassCalibration calibrate(const std::vector<const TemperingLog*>& logs, const Exponents& exponents,
                           const TemperingParams& params);

/// Two-fold cross-validation over the logs; needs at least two.
StudyReport temperingStudy(const TemperingParams& params, const std::vector<TemperingLog>& logs);

}  // namespace perception
