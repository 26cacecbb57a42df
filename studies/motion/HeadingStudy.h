#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/StudyReport.h"
#include "libperception/filter/state/Heading.h"

namespace perception {

/// Tracking of a single vehicle with a camera whose headings may be reversed (method.md 7).
struct HeadingParams {
  int runs = 80;
  std::vector<double> flip_probabilities = {0.1, 0.2, 0.3, 0.4, 0.45};
  std::uint64_t seed = 1;
};

/// Use of measured headings.
struct HeadingMethod {
  std::string label;
  HeadingMode mode = HeadingMode::kSplit;
  bool naive = false;  ///< takes every heading as correct
};
const std::vector<HeadingMethod>& headingMethods();

/// Metrics of the track, mean over runs.
struct HeadingFigures {
  double tracked = 0;             ///< share of instants in view with an estimate within 2 m
  double position_rms = 0;        ///< [m] at these instants
  double heading_rms = 0;         ///< [rad]
  double right_way = 0;           ///< share with a heading error below 90 degrees
  double velocity_rms = 0;        ///< [m/s] of the velocity vector
  double lost = 0, rejected = 0;  ///< tracks lost, measurements rejected by the gate, per run
};
HeadingFigures runHeading(const HeadingMethod& method, bool radar, double flip_probability,
                          const HeadingParams& params);

StudyReport headingStudy(const HeadingParams& params);

}  // namespace perception
