#pragma once
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <string>

#include "libperception/config/Config.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/RecordedLog.h"
#include "libperception/scene/MeasurementRun.h"

namespace perception {

/// Changes an observation between log and front end.
using ObservationEdit = std::function<void(mrpt::obs::CObservation&)>;

/// Reads a log once through the front ends of a configuration. `seconds` of it; 0 = all. Throws
/// DataError when no scene comes of it.
RecordedLog recordLog(const std::string& log, Config& config, double seconds,
                      const ObservationEdit& edit = {});

/// What the sensor of a scan is expected to see, by its section of the INI.
RecordedSensor describeSensor(const PipelineSetup& setup, const MeasurementScan& scan);

}  // namespace perception
