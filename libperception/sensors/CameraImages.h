#pragma once
#include <mrpt/obs/CObservationImage.h>

#include <optional>
#include <string>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Where MRPT's programs keep the images of a log: LOG_Images beside LOG.rawlog.
std::string imagesBeside(const std::string& log);

/// The image with its camera; pixels are loaded when asked for, from the log or, for images stored
/// outside, from `folder`. load() of an image that is missing or that no decoder reads gives
/// nothing and throws nothing.
CameraImage cameraImage(const mrpt::obs::CObservationImage& observation, const std::string& folder);

/// The camera of a picture without calibration, as logs hold panoramas of the whole sphere
/// (equirectangular): twice as wide as high, 1024 px or more, the smallest of [radecki2016]. Empty:
/// a picture of another shape.
std::optional<CameraModel> panoramaModel(int width, int height);

}  // namespace perception
