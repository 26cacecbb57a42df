#pragma once
#include <mrpt/maps/CMetricMap.h>
#include <mrpt/version.h>

#include <memory>

// Where versions of MRPT differ: 2.5.8 (Debian 12), 2.14.7 (Debian 13). MRPT 3 will need more,
// known from its headers and notes and not tried: targets mrpt::mrpt_obs for mrpt::obs, and Eigen
// found by us; CObservation::getSensorPose() by value; mrpt::viz for the objects of mrpt::opengl;
// images without OpenCV; intensities and rings as fields of CGenericPointsMap (clouds stored as
// CPointsMapXYZI no longer load); TEntryType of CRawlog and TParticleFilterAlgorithm as enum
// classes.

namespace perception {

/// What internal_CreateFromMapDefinition() of a metric map returns.
#if MRPT_VERSION >= 0x020E00
using NewMetricMap = std::shared_ptr<mrpt::maps::CMetricMap>;
#else
using NewMetricMap = mrpt::maps::CMetricMap*;
#endif

}  // namespace perception
