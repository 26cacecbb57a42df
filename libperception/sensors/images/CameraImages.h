#pragma once
#include <mrpt/obs/CObservationImage.h>

#include <optional>
#include <string>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// MRPT's folder of external images: LOG_Images beside LOG.rawlog.
std::string imagesBeside(const std::string& log);

/// The image with its camera; pixels are loaded on demand, from the log or, for external images,
/// from `folder`. load() returns nothing for an image that is missing or cannot be decoded; it does
/// not throw.
CameraImage cameraImage(const mrpt::obs::CObservationImage& observation, const std::string& folder);

/// The camera of a picture without calibration, as logs hold panoramas of the whole sphere
/// (equirectangular): twice as wide as high, 1024 px or more, the smallest of [radecki2016]. Empty:
/// a picture of another shape.
std::optional<CameraModel> panoramaModel(int width, int height);

}  // namespace perception
