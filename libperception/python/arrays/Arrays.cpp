#include "libperception/python/arrays/Arrays.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

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
constexpr double kLongestScan = 10;

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

/// Columns of an (n, 3) array by its strides: any layout, no copy before.
template <class Number>
void readPoints(const py::array& array, LidarCloud& cloud) {
  const auto points = py::reinterpret_borrow<py::array_t<Number>>(array).template unchecked<2>();
  const auto n = static_cast<std::size_t>(points.shape(0));
  cloud.x.resize(n), cloud.y.resize(n), cloud.z.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    cloud.x[i] = static_cast<float>(points(row, 0));
    cloud.y[i] = static_cast<float>(points(row, 1));
    cloud.z[i] = static_cast<float>(points(row, 2));
  }
}

/// One number a return, or nothing. Of whole numbers those beyond the range of `Number` are an
/// error.
template <class Number>
std::vector<Number> columnOf(const py::object& object, const char* what, std::size_t n) {
  if (object.is_none()) return {};
  const py::array array = asArray(object, what);
  checkNumbers(array, what);
  checkShape(array, what, 0, static_cast<py::ssize_t>(n));
  if constexpr (std::is_integral_v<Number>) {
    if (array.dtype().kind() == 'f')
      throw DataError(fmt::format("{}: dtype {}, expected whole numbers", what, dtypeOf(array)));
    const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(array);
    std::vector<Number> values(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t value = wide.data()[i];
      if (value < 0 || value > std::numeric_limits<Number>::max())
        throw DataError(fmt::format("{}[{}]: {}, expected 0 to {}", what, i, value,
                                    std::numeric_limits<Number>::max()));
      values[i] = static_cast<Number>(value);
    }
    return values;
  } else {
    const auto cast = py::array_t<Number, py::array::c_style | py::array::forcecast>(array);
    return {cast.data(), cast.data() + n};
  }
}

/// Absolute times in place of times after the stamp would be silently absurd.
void checkTimes(const std::vector<float>& times) {
  for (const float time : times) {
    if (std::abs(time) > kLongestScan)
      throw DataError(fmt::format(
          "time: {} s after the stamp is none of a scan; expected seconds after the stamp, of "
          "absolute times (time - stamp), of nanoseconds 1e-9 * time",
          time));
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

LidarCloud cloudOf(const py::handle& xyz, const ReturnArrays& arrays) {
  const py::array points = asArray(xyz, "xyz");
  if (points.ndim() == 2 && points.shape(1) == 4)
    throw DataError(
        "xyz: shape (n, 4), expected (n, 3): give xyz[:, :3], and xyz[:, 3] as "
        "intensity");
  checkShape(points, "xyz", 3, {});
  LidarCloud cloud;
  if (py::isinstance<py::array_t<float>>(points)) {
    readPoints<float>(points, cloud);
  } else if (py::isinstance<py::array_t<double>>(points)) {
    readPoints<double>(points, cloud);
  } else {
    throw DataError(fmt::format("xyz: dtype {}, expected float32 (or float64)", dtypeOf(points)));
  }
  const std::size_t n = cloud.size();
  cloud.intensity = columnOf<float>(arrays.intensity, "intensity", n);
  cloud.ring = columnOf<std::uint16_t>(arrays.ring, "ring", n);
  cloud.time_offset = columnOf<float>(arrays.time, "time", n);
  checkTimes(cloud.time_offset);
  cloud.echo = columnOf<std::uint8_t>(arrays.echo, "echo", n);
  cloud.pulse_width = columnOf<float>(arrays.pulse_width, "pulse_width", n);
  cloud.label = columnOf<std::uint8_t>(arrays.label, "label", n);
  return cloud;
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
