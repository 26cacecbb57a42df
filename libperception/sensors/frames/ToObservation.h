#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <memory>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

inline constexpr const char* kEgoPoseLabel = "EGO_POSE";
inline constexpr const char* kFrameLabel = "FRAME";

/// The inverse of frameFromObservation(): a lidar scan, a radar scan or object detections of our
/// own classes; an image as CObservationImage with its pixels in the log, JPEG compressed when
/// written (a setting of MRPT's for the whole program). MRPT knows no spherical camera: a panorama
/// comes without calibration, as panoramaModel() expects it.
std::shared_ptr<mrpt::obs::CObservation> observationFromFrame(const SensorFrame& frame);
/// The vehicle's pose with its uncertainty (a standard deviation of 0 in z and roll) as
/// CObservationRobotPose.
std::shared_ptr<mrpt::obs::CObservation> poseObservation(const EgoState& ego,
                                                         const std::string& label = kEgoPoseLabel);
/// The frame number as CObservationComment "frame N".
std::shared_ptr<mrpt::obs::CObservation> frameComment(Stamp stamp, std::int64_t number);

}  // namespace perception
