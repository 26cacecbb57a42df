#pragma once
#include <string>

#include "libperception/doctor/Findings.h"

namespace perception {

/// Adds what a lidar's, radar's or camera's own motion says about its mounting and clock, compared
/// with the log's poses. Adds nothing if the log has no poses, or for a scanner of one layer.
/// `about` is the name of the sensor in the findings.
void addMotionFindings(const LogSurvey& survey, const std::string& about, const SensorFacts& facts,
                       Findings& out);

/// Adds the same for every GNSS receiver of the log: its clock and the place of its antenna.
void addGnssFindings(const LogSurvey& survey, Findings& out);

}  // namespace perception
