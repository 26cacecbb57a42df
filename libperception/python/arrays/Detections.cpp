#include "libperception/python/arrays/Detections.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/python/arrays/Arrays.h"

namespace perception::python {
namespace py = pybind11;
namespace {

/// [m] size of a point, which no front end reads unless `sizes = true`.
constexpr double kPointSize = 1;

std::vector<ObjectDetection> scored(py::ssize_t n, const py::handle& scores,
                                    const std::vector<std::string>& labels,
                                    const std::string& owner) {
  const auto numbers = numbersOf(scores, owner + "scores", 0, n);
  if (static_cast<py::ssize_t>(labels.size()) != n)
    throw DataError(fmt::format("{}labels: {}, expected {}, one a box", owner, labels.size(), n));
  std::vector<ObjectDetection> objects(labels.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    objects[i].label = labels[i];
    objects[i].score = numbers.data()[i];
  }
  return objects;
}

/// (n, 2) or (n, 3) as boxes of one meter.
py::array_t<double> boxesOfPoints(const py::array& points, const std::string& owner) {
  const int columns = static_cast<int>(points.shape(1));
  const auto places = numbersOf(points, owner + "points", columns);
  py::array_t<double> boxes({places.shape(0), py::ssize_t{7}});
  auto cells = boxes.mutable_unchecked<2>();
  const auto place = places.unchecked<2>();
  for (py::ssize_t i = 0; i < places.shape(0); ++i) {
    for (py::ssize_t j = 0; j < 7; ++j) cells(i, j) = j < 3 || j == 6 ? 0 : kPointSize;
    for (py::ssize_t j = 0; j < columns; ++j) cells(i, j) = place(i, j);
  }
  return boxes;
}

}  // namespace

ObjectDetections spaceBoxes(const py::handle& boxes, const py::handle& scores,
                            const std::vector<std::string>& labels, bool centered,
                            const std::string& owner) {
  const auto rows = numbersOf(boxes, owner + "boxes", 7);
  ObjectDetections detections;
  detections.objects = scored(rows.shape(0), scores, labels, owner);
  const auto cells = rows.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    ObjectDetection::SpaceBox box;
    box.length = cells(i, 3), box.width = cells(i, 4), box.height = cells(i, 5);
    box.bottom_center = {cells(i, 0), cells(i, 1), cells(i, 2) - (centered ? box.height / 2 : 0)};
    box.yaw = cells(i, 6);
    detections.objects[static_cast<std::size_t>(i)].space_box = box;
  }
  return detections;
}

ObjectDetections imageBoxesOf(const py::handle& boxes, const py::handle& scores,
                              const std::vector<std::string>& labels, const CameraNumbers& camera,
                              const py::object& headings) {
  const auto rows = numbersOf(boxes, "boxes", 4);
  const py::ssize_t n = rows.shape(0);
  ObjectDetections detections;
  auto& [width, height, fx, fy, cx, cy] = camera;
  if (width <= 0 || height <= 0 || !(fx > 0) || !(fy > 0) || !std::isfinite(cx + cy))
    throw DataError("camera: expected (width, height, fx, fy, cx, cy) in pixels");
  detections.camera.width = width, detections.camera.height = height;
  detections.camera.fx = fx, detections.camera.fy = fy;
  detections.camera.cx = cx, detections.camera.cy = cy;
  detections.objects = scored(n, scores, labels, "");
  const auto cells = rows.unchecked<2>();
  std::optional<py::array_t<double>> angles;
  if (!headings.is_none()) angles = numbersOf(headings, "headings", 0, n);
  for (py::ssize_t i = 0; i < n; ++i) {
    ObjectDetection& object = detections.objects[static_cast<std::size_t>(i)];
    object.image_box = {cells(i, 0), cells(i, 1), cells(i, 2), cells(i, 3)};
    if (angles && !std::isnan(angles->data()[i])) object.heading = angles->data()[i];
  }
  return detections;
}

RadarReturns radarReturns(const RadarArrays& arrays, double max_range) {
  const auto ranges = numbersOf(arrays.range, "range", 0);
  const py::ssize_t n = ranges.shape(0);
  const auto bearings = numbersOf(arrays.bearing, "bearing", 0, n);
  const auto optional = [n](const py::object& array, const char* what) {
    std::optional<py::array_t<double>> numbers;
    if (!array.is_none()) numbers = numbersOf(array, what, 0, n);
    return numbers;
  };
  const auto rates = optional(arrays.range_rate, "range_rate");
  const auto amplitudes = optional(arrays.amplitude, "amplitude");
  const auto elevations = optional(arrays.elevation, "elevation");
  RadarReturns returns;
  returns.max_range = max_range;
  for (py::ssize_t i = 0; i < n; ++i) {
    RadarReturn r;
    r.range = ranges.data()[i], r.bearing = bearings.data()[i];
    r.has_rate = rates && !std::isnan(rates->data()[i]);
    if (r.has_rate) r.range_rate = rates->data()[i];
    if (amplitudes) r.amplitude = amplitudes->data()[i];
    if (elevations && !std::isnan(elevations->data()[i])) r.elevation = elevations->data()[i];
    returns.returns.push_back(r);
  }
  return returns;
}

ObjectDetections returnedBoxes(const py::object& returned, const std::string& owner) {
  if (returned.is_none()) return {};
  py::object boxes = returned, scores = py::none(), labels = py::none();
  if (py::isinstance<py::tuple>(returned)) {
    const auto parts = py::reinterpret_borrow<py::tuple>(returned);
    if (parts.size() < 1 || parts.size() > 3)
      throw DataError(owner + "expected boxes, (boxes, scores) or (boxes, scores, labels)");
    boxes = parts[0];
    if (parts.size() > 1) scores = parts[1];
    if (parts.size() > 2) labels = parts[2];
  }
  const auto array = py::array::ensure(boxes);
  if (!array) PyErr_Clear();
  if (array && array.ndim() == 2 && (array.shape(1) == 2 || array.shape(1) == 3))
    boxes = boxesOfPoints(array, owner);
  const auto n = static_cast<std::size_t>(numbersOf(boxes, owner + "boxes", 7).shape(0));
  if (scores.is_none()) scores = arrayOf(std::vector<double>(n, 1.0));
  std::vector<std::string> names(n, "object");
  try {
    if (!labels.is_none()) names = py::cast<std::vector<std::string>>(labels);
  } catch (const py::cast_error&) {
    throw DataError(owner + "labels: expected a list of names");
  }
  return spaceBoxes(boxes, scores, names, false, owner);
}

}  // namespace perception::python
