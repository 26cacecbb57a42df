#pragma once
#include <string>

namespace perception::test {

inline const std::string kDemoLog = PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog";
inline const std::string kDemoTruth = PERCEPTION_SOURCE_DIR "/rawlogs/demo.truth.csv";
inline constexpr double kDemoFirstStamp = 1577836800;  // [s]

}  // namespace perception::test
