#pragma once
#include <string>

#include "libperception/doctor/LogSurvey.h"

namespace perception {

/// Where the first INI takes object classes and the cluster model from.
struct SiteFiles {
  std::string classes;  ///< ini/classes.ini, as seen from the INI's folder
  std::string model;    ///< ini/models/lidar_recordings.json, the same; empty: labels by size
};

/// Detector's class name = label of ours (car, person), for names of common data sets; empty for
/// others.
std::string knownName(const std::string& name);

/// A first INI for the log's vehicle: labels, kinds, ranges, fields of view and mountings as found,
/// everything else as in ini/kitti.ini, which was tuned on recordings. Runs without edits;
/// empty if no sensor's observations can be used.
std::string siteIni(const LogSurvey& survey, const SiteFiles& files, const std::string& log);

}  // namespace perception
