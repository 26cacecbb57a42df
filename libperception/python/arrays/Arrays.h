#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::python {

/// A float in seconds, a whole number in nanoseconds or a numpy.datetime64, since 1970. Throws
/// DataError.
Stamp stampOf(const pybind11::handle& stamp);

/// A rigid 4x4 matrix. Throws DataError naming `what`.
Pose3 poseOf(const pybind11::handle& matrix, const std::string& what);
/// The 4x4 matrix of a pose.
pybind11::array_t<double> matrixOf(const Pose3& pose);

/// Attributes of returns beside their places; each None or an array with one number a return.
struct ReturnArrays {
  pybind11::object intensity, ring, time, echo, pulse_width, label;
};
/// Points (n, 3) of float32 or float64, of any strides, and what is known of them, into the arrays
/// of `cloud`, whose memory is used again; trust and max_range stay. Throws DataError.
void readCloud(const pybind11::handle& xyz, const ReturnArrays& arrays, LidarCloud& cloud);

/// (n, `columns`) numbers as float64; `columns` 0: (n,). Throws DataError naming `what`. `rows`: n,
/// where it is known.
pybind11::array_t<double> numbersOf(const pybind11::handle& array, const std::string& what,
                                    int columns, std::optional<pybind11::ssize_t> rows = {});

/// A vector as an array with one dimension.
template <class Number>
pybind11::array_t<Number> arrayOf(const std::vector<Number>& values) {
  return pybind11::array_t<Number>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

}  // namespace perception::python
