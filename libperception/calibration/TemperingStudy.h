#pragma once
#include <vector>

#include "libperception/calibration/TemperedLog.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/evaluation/Evaluation.h"
#include "libperception/evaluation/StudyReport.h"

namespace perception {

/// Exponents of maximum likelihood of the true class.
struct TemperingParams {
  Proposal proposal = Proposal::kRanked;
  int particles = 8;
  std::uint64_t seed = 1;
  int rounds = 2;                ///< of the search, one exponent after the other (assumed)
  EvaluationOptions evaluation;  ///< where truth counts
};

/// A log with its truth.
struct TemperingLog {
  RecordedLog log;
  GroundTruth truth;
};

/// How well the class posterior is calibrated on some logs.
struct ClassCalibration {
  double log_likelihood = 0;      ///< mean of log P(true class) over tracked objects and instants
  double ece = 0;                 ///< expected calibration error of the likeliest class
  double correct = 0, wrong = 0;  ///< shares that are classified as their class, as another one
  std::size_t samples = 0;
};
ClassCalibration calibrate(const std::vector<const TemperingLog*>& logs, const Exponents& exponents,
                           const TemperingParams& params);

/// Fits on every second log and scores on the others, and the other way round; needs two logs.
StudyReport temperingStudy(const TemperingParams& params, const std::vector<TemperingLog>& logs);

}  // namespace perception
