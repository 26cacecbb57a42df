#pragma once
#include <string>

#include "libperception/core/Config.h"
#include "libperception/study/RecordedLog.h"

namespace perception {

/// Reads a log once through the front ends of a configuration. `seconds` of it; 0 = all. Throws
/// DataError when no scene comes of it.
RecordedLog recordLog(const std::string& log, Config& config, double seconds);

}  // namespace perception
