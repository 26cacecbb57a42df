#pragma once
#include <pybind11/pybind11.h>

#include <string>
#include <tuple>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::python {

/// Boxes (n, 7) of x, y, z, length, width, height [m], yaw [rad] in the sensor frame with their
/// scores and labels. `centered`: z is that of the center, not of the bottom. `owner` stands before
/// the names of arrays in errors (DataError).
ObjectDetections spaceBoxes(const pybind11::handle& boxes, const pybind11::handle& scores,
                            const std::vector<std::string>& labels, bool centered,
                            const std::string& owner);

/// width, height [px], fx, fy, cx, cy [px].
using CameraNumbers = std::tuple<int, int, double, double, double, double>;
/// Boxes (n, 4) of left, top, right, bottom [px]; headings [rad] or None. Throws DataError.
ObjectDetections imageBoxesOf(const pybind11::handle& boxes, const pybind11::handle& scores,
                              const std::vector<std::string>& labels, const CameraNumbers& camera,
                              const pybind11::object& headings);

/// One number a target; the last three may be None.
struct RadarArrays {
  pybind11::object range, bearing, range_rate, amplitude, elevation;
};
/// Throws DataError.
RadarReturns radarReturns(const RadarArrays& arrays, double max_range);

/// What a front end written in Python returned: boxes (n, 7) as above, of z at the bottom, or
/// points (n, 2) or (n, 3); alone or as (boxes, scores) or (boxes, scores, labels); None: nothing.
/// Scores are 1 and labels "object" where they are left out. Throws DataError that begins with
/// `owner`.
ObjectDetections returnedBoxes(const pybind11::object& returned, const std::string& owner);

}  // namespace perception::python
