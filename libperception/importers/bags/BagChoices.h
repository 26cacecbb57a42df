#pragma once
#include <string>

#include "libperception/config/Config.h"
#include "libperception/core/Frames.h"
#include "libperception/importers/ImportLog.h"
#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/bags/BagMeasurements.h"
#include "libperception/interop/ros/PoseSeries.h"

namespace perception {

/// What a recording is imported with: said by an INI, or found in the recording.
struct BagChoices {
  BagTopicParamsByName topics;  ///< those that the INI names
  std::string base;             ///< frame of the vehicle
  Pose3 T_ego_base = Pose3::Identity();
  std::string frames_topic;  ///< whose messages are the log's frames; empty: there is none
  std::string poses_from;    ///< whose the poses are, for people; empty: none are taken
  PoseSeries poses;          ///< of the ego frame
};

/// Throws ConfigError: the INI names what the recording does not have.
BagChoices chooseFrom(const BagContents& contents, Config& config, ImportLog& log);

/// Adds the poses of topics to the tree of frames where a sensor's messages are in the frame of
/// reference of these poses, and no transforms lead from there to the vehicle.
void plantPoses(const BagChoices& choices, BagContents& contents);

}  // namespace perception
