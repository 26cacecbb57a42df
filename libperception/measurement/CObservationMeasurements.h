#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include <cstdint>
#include <string>
#include <vector>

#include "libperception/measurement/Measurement.h"

namespace perception {

/// The measurements of one sensor at one instant as an observation: z with covariance R under a
/// named measurement model. Lets the output of a front end be recorded in a rawlog, viewed with
/// MRPT's tools and replayed.
class CObservationMeasurements : public mrpt::obs::CObservation {
  DEFINE_SERIALIZABLE(CObservationMeasurements, perception)
 public:
  std::string model;  ///< the measurement model, by the name of its class ("FootprintModel")
  Modality modality = Modality::kLidar;
  std::int64_t frame = -1;  ///< the log's frame number; -1 = none
  std::vector<std::string>
      axes;  ///< names of the axes of z ("left", "right", "range"), for readers
  std::vector<std::string> labels;  ///< what Measurement::label indexes
  std::vector<Measurement> measurements;
  mrpt::poses::CPose3D sensor_pose;  ///< pose of the sensor in the vehicle frame

  void getSensorPose(mrpt::poses::CPose3D& pose) const override { pose = sensor_pose; }
  void setSensorPose(const mrpt::poses::CPose3D& pose) override { sensor_pose = pose; }
  void getDescriptionAsText(std::ostream& out) const override;
  bool exportTxtSupported() const override { return true; }
  std::string exportTxtHeader() const override;
  std::string exportTxtDataRow() const override;
};

}  // namespace perception
