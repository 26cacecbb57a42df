#include "libperception/python/arrays/Arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "libperception/core/Error.h"

namespace perception::python {
namespace py = pybind11;
namespace {

/// [-] A rotation matrix from a file with few digits is this far from a rotation.
constexpr double kRotationError = 1e-3;
/// [s] since 1970, beyond what 64 bits of nanoseconds hold.
constexpr double kLatestSecond = 9e9;
/// [ns] Whole numbers below are no nanoseconds of a recording: 1970-01-12.
constexpr std::int64_t kFirstNanoseconds = 1'000'000'000'000'000;
/// [s] No scan lasts longer; assumed: a lidar turns in a twentieth to a second.
constexpr float kLongestScan = 10;

std::string shapeOf(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return "(" + text + (array.ndim() == 1 ? ",)" : ")");
}

/// What numpy makes of the object; DataError in place of numpy's exception.
py::array asArray(const py::handle& object, const std::string& what) {
  auto array = py::array::ensure(object);
  if (!array) {
    PyErr_Clear();
    throw DataError(what + ": expected an array of numbers");
  }
  return array;
}

std::string dtypeOf(const py::array& array) { return py::str(array.dtype()); }

void checkNumbers(const py::array& array, const std::string& what) {
  if (std::strchr("fiub", array.dtype().kind()) == nullptr)
    throw DataError(fmt::format("{}: dtype {}, expected numbers", what, dtypeOf(array)));
}

void checkShape(const py::array& array, const std::string& what, int columns,
                std::optional<py::ssize_t> rows) {
  const bool fits = array.ndim() == (columns > 0 ? 2 : 1) &&
                    (columns == 0 || array.shape(1) == columns) &&
                    (!rows || array.shape(0) == *rows);
  if (fits) return;
  const std::string n = rows ? std::to_string(*rows) : "n";
  throw DataError(fmt::format("{}: shape {}, expected ({},{})", what, shapeOf(array), n,
                              columns > 0 ? fmt::format(" {}", columns) : ""));
}

/// A number of an array; in a record it may lie at any address.
template <class Number>
Number numberAt(const char* place) {
  Number number;
  std::memcpy(&number, place, sizeof number);
  return number;
}

/// One number after another, each at an address of its type.
bool isPacked(const py::array& array) {
  constexpr int kWanted = static_cast<int>(py::array::c_style) |
                          static_cast<int>(py::detail::npy_api::NPY_ARRAY_ALIGNED_);
  return (array.flags() & kWanted) == kWanted;
}

/// Rows of three numbers one after another, as columns: a loop of which the compiler makes vectors.
template <class Number>
void splitRows(const Number* __restrict rows, std::size_t count, LidarCloud& cloud) {
  float* __restrict x = cloud.x.data();
  float* __restrict y = cloud.y.data();
  float* __restrict z = cloud.z.data();
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = static_cast<float>(rows[3 * i]);
    y[i] = static_cast<float>(rows[3 * i + 1]);
    z[i] = static_cast<float>(rows[3 * i + 2]);
  }
}

/// Columns of an (n, 3) array by its strides: any layout, no copy before.
template <class Number>
void readPoints(const py::array& array, LidarCloud& cloud) {
  const py::ssize_t down = array.strides(0), right = array.strides(1);
  const auto n = static_cast<std::size_t>(array.shape(0));
  cloud.x.resize(n), cloud.y.resize(n), cloud.z.resize(n);
  if (isPacked(array)) return splitRows(static_cast<const Number*>(array.data()), n, cloud);
  const auto* row = static_cast<const char*>(array.data());
  float* __restrict x = cloud.x.data();
  float* __restrict y = cloud.y.data();
  float* __restrict z = cloud.z.data();
  for (std::size_t i = 0; i < n; ++i, row += down) {
    x[i] = static_cast<float>(numberAt<Number>(row));
    y[i] = static_cast<float>(numberAt<Number>(row + right));
    z[i] = static_cast<float>(numberAt<Number>(row + 2 * right));
  }
}

/// Numbers of the type that is wanted, of any stride.
template <class Number>
void copyNumbers(const py::array& array, std::vector<Number>& values) {
  const auto* first = static_cast<const char*>(array.data());
  const py::ssize_t down = array.strides(0);
  if (isPacked(array)) {
    std::copy_n(static_cast<const Number*>(array.data()), values.size(), values.begin());
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = numberAt<Number>(first + static_cast<py::ssize_t>(i) * down);
}

/// Whole numbers of another type; those beyond the range of `Number` are an error.
template <class Number>
void convertWhole(const py::array& array, const char* what, std::vector<Number>& values) {
  if (array.dtype().kind() == 'f')
    throw DataError(fmt::format("{}: dtype {}, expected whole numbers", what, dtypeOf(array)));
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::int64_t value = wide.data()[i];
    if (value < 0 || value > std::numeric_limits<Number>::max())
      throw DataError(fmt::format("{}[{}]: {}, expected 0 to {}", what, i, value,
                                  std::numeric_limits<Number>::max()));
    values[i] = static_cast<Number>(value);
  }
}

/// One number a return, or nothing.
template <class Number>
void readColumn(const py::object& object, const char* what, std::size_t n,
                std::vector<Number>& values) {
  if (object.is_none()) return values.clear();
  const py::array array = asArray(object, what);
  checkNumbers(array, what);
  checkShape(array, what, 0, static_cast<py::ssize_t>(n));
  values.resize(n);
  if (py::isinstance<py::array_t<Number>>(array)) {
    copyNumbers(array, values);
  } else if constexpr (std::is_integral_v<Number>) {
    convertWhole(array, what, values);
  } else {
    copyNumbers<Number>(py::array_t<Number, py::array::forcecast>(array), values);
  }
}

/// Absolute times in place of times after the stamp would be silently absurd.
void checkTimes(const std::vector<float>& times) {
  unsigned absurd = 0;  // counted without a branch, several at once
  for (const float time : times) absurd += std::abs(time) > kLongestScan ? 1 : 0;
  for (std::size_t i = 0; absurd > 0 && i < times.size(); ++i) {
    if (std::abs(times[i]) > kLongestScan)
      throw DataError(fmt::format(
          "time: {} s after the stamp is none of a scan; expected seconds after the stamp, of "
          "absolute times (time - stamp), of nanoseconds 1e-9 * time",
          times[i]));
  }
}

Stamp notZero(Stamp stamp) {
  if (stamp.ns == 0)
    throw DataError(
        "stamp: 0 is no time (logs have it where there is none); where time starts at 0, add an "
        "offset to all stamps, as 1e9 + k / 10");
  return stamp;
}

}  // namespace

Stamp stampOf(const py::handle& stamp) {
  const std::string kind =
      py::hasattr(stamp, "dtype") ? py::cast<std::string>(stamp.attr("dtype").attr("kind")) : "";
  if (!kind.empty() && py::cast<int>(stamp.attr("ndim")) != 0)
    throw DataError("stamp: an array, expected one number or datetime64");
  if (kind == "f" && py::cast<int>(stamp.attr("dtype").attr("itemsize")) < 8)
    throw DataError("stamp: a float of less than 64 bits does not hold seconds since 1970");
  if (kind == "M")
    return notZero(
        {py::cast<std::int64_t>(stamp.attr("astype")("datetime64[ns]").attr("astype")("int64"))});
  if (!py::hasattr(stamp, "__index__")) {
    if (!py::hasattr(stamp, "__float__"))
      throw DataError(
          "stamp: expected seconds since 1970 as float, nanoseconds as int or datetime64");
    const double seconds = py::cast<double>(stamp.attr("__float__")());
    if (!std::isfinite(seconds) || std::abs(seconds) > kLatestSecond)
      throw DataError(fmt::format("stamp: {} s is no time since 1970", seconds));
    return notZero(Stamp::fromSeconds(seconds));
  }
  std::int64_t ns = 0;
  try {
    ns = py::cast<std::int64_t>(stamp.attr("__index__")());
  } catch (const py::cast_error&) {
    throw DataError("stamp: expected nanoseconds of 64 bits");
  }
  if (notZero({ns}).ns < kFirstNanoseconds)
    throw DataError(fmt::format(
        "stamp: whole numbers are nanoseconds since 1970, and {} is none of a recording; seconds "
        "are given as float",
        ns));
  return {ns};
}

Pose3 poseOf(const py::handle& matrix, const std::string& what) {
  const py::array array = asArray(matrix, what);
  checkNumbers(array, what);
  checkShape(array, what, 4, 4);
  const auto cast = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
  const auto m = cast.unchecked<2>();
  Pose3 pose = Pose3::Identity();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) pose.matrix()(i, j) = m(i, j);
  }
  if (!pose.matrix().allFinite()) throw DataError(what + ": values that are not finite");
  const auto R = pose.linear();
  const double off = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > kRotationError || R.determinant() < 0)
    throw DataError(what + ": its upper left 3x3 is no rotation");
  if ((pose.matrix().row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > 1e-9)
    throw DataError(what + ": its last row is not 0 0 0 1");
  return pose;
}

py::array_t<double> matrixOf(const Pose3& pose) {
  py::array_t<double> matrix({4, 4});
  auto m = matrix.mutable_unchecked<2>();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) m(i, j) = pose.matrix()(i, j);
  }
  return matrix;
}

void readCloud(const py::handle& xyz, const ReturnArrays& arrays, LidarCloud& cloud) {
  const py::array points = asArray(xyz, "xyz");
  if (points.ndim() == 2 && points.shape(1) == 4)
    throw DataError(
        "xyz: shape (n, 4), expected (n, 3): give xyz[:, :3], and xyz[:, 3] as "
        "intensity");
  checkShape(points, "xyz", 3, {});
  if (py::isinstance<py::array_t<float>>(points)) {
    readPoints<float>(points, cloud);
  } else if (py::isinstance<py::array_t<double>>(points)) {
    readPoints<double>(points, cloud);
  } else {
    throw DataError(fmt::format("xyz: dtype {}, expected float32 (or float64)", dtypeOf(points)));
  }
  const std::size_t n = cloud.size();
  readColumn(arrays.intensity, "intensity", n, cloud.intensity);
  readColumn(arrays.ring, "ring", n, cloud.ring);
  readColumn(arrays.time, "time", n, cloud.time_offset);
  checkTimes(cloud.time_offset);
  readColumn(arrays.echo, "echo", n, cloud.echo);
  readColumn(arrays.pulse_width, "pulse_width", n, cloud.pulse_width);
  readColumn(arrays.label, "label", n, cloud.label);
}

py::array_t<double> numbersOf(const py::handle& object, const std::string& what, int columns,
                              std::optional<py::ssize_t> rows) {
  const py::array array = asArray(object, what);
  checkNumbers(array, what);
  if (columns > 0 && array.size() == 0 && array.ndim() <= 2 && (!rows || *rows == 0))
    return py::array_t<double>(
        std::vector<py::ssize_t>{0, columns});  // an empty list has no columns
  checkShape(array, what, columns, rows);
  return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

}  // namespace perception::python
