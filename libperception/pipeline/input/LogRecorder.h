#pragma once
#include <mrpt/obs/CObservation.h>

#include <functional>
#include <optional>
#include <string>

#include "libperception/config/Config.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/pipeline/input/RecordedLog.h"
#include "libperception/scene/files/MeasurementRun.h"

namespace perception {

/// Modifies an observation before its front end.
using ObservationEdit = std::function<void(mrpt::obs::CObservation&)>;

/// Reads the first `seconds` of a log (0 = all) through the front ends of a configuration. Its
/// filter runs, too, for the wakes of tracked vehicles are a cause of phantoms. Throws DataError
/// when there is no scene.
RecordedLog recordLog(const std::string& log, Config& config, double seconds,
                      const ObservationEdit& edit = {});

/// What is known of a log after a pass.
struct LogPass {
  bool simulated = false;
  std::optional<Stamp> first_stamp;
};

/// The configuration for a pass whose tracks and free distance are not used: what is cheapest.
PipelineSetup forFrontEnds(PipelineSetup setup);

/// Passes the first `seconds` of a log (0 = all) through the pipeline of a configuration, to the
/// observer.
LogPass passLog(const std::string& log, PipelineSetup setup, double seconds,
                PipelineObserver& observer, const ObservationEdit& edit = {});

/// Description of the sensor of a scan, from its section of the INI.
RecordedSensor describeSensor(const PipelineSetup& setup, const MeasurementScan& scan);

}  // namespace perception
