#pragma once
#include <mrpt/obs/CObservation.h>

#include <optional>
#include <string>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A camera image of a log as a frame that loads its pixels when asked: from the log itself or from
/// the folder of external images beside it, LOG_Images, as MRPT's programs do. Empty for other
/// observations. `log`: path of the rawlog.
std::optional<SensorFrame> imageFrame(const mrpt::obs::CObservation& observation,
                                      const std::string& log);

}  // namespace perception
