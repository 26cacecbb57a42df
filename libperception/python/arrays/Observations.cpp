#include "libperception/python/arrays/Observations.h"

#include <mrpt/obs/CObservationRobotPose.h>
#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/python/arrays/Arrays.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception::python {
namespace py = pybind11;
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

template <class Number>
py::object arrayOrNone(const std::vector<Number>& values) {
  return values.empty() ? py::none() : py::object(arrayOf(values));
}

/// Rows of equal length as an array (n, Columns).
template <std::size_t Columns>
py::array_t<double> tableOf(const std::vector<std::array<double, Columns>>& rows) {
  py::array_t<double> table({rows.size(), Columns});
  auto cells = table.mutable_unchecked<2>();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < Columns; ++j)
      cells(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(j)) = rows[i][j];
  }
  return table;
}

py::dict fieldsOf(const LidarCloud& cloud) {
  py::array_t<float> xyz({static_cast<py::ssize_t>(cloud.size()), py::ssize_t{3}});
  auto points = xyz.mutable_unchecked<2>();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    points(row, 0) = cloud.x[i], points(row, 1) = cloud.y[i], points(row, 2) = cloud.z[i];
  }
  py::dict fields;
  fields["xyz"] = xyz;
  fields["intensity"] = arrayOrNone(cloud.intensity);
  fields["ring"] = arrayOrNone(cloud.ring);
  fields["time"] = arrayOrNone(cloud.time_offset);
  fields["echo"] = arrayOrNone(cloud.echo);
  fields["pulse_width"] = arrayOrNone(cloud.pulse_width);
  fields["label"] = arrayOrNone(cloud.label);
  fields["trust"] = arrayOrNone(cloud.trust);
  fields["max_range"] = cloud.max_range;
  return fields;
}

py::dict fieldsOf(const RadarReturns& radar) {
  std::vector<std::array<double, 5>> rows;
  for (const RadarReturn& r : radar.returns)
    rows.push_back({r.range, r.bearing, r.has_rate ? r.range_rate : kNone, r.amplitude,
                    r.elevation.value_or(kNone)});
  py::dict fields;
  fields["targets"] = tableOf(rows);
  fields["max_range"] = radar.max_range;
  return fields;
}

py::dict fieldsOf(const ObjectDetections& detections) {
  std::vector<std::array<double, 7>> boxes;
  std::vector<std::array<double, 4>> image_boxes;
  std::vector<double> scores, headings;
  py::list labels;
  for (const ObjectDetection& d : detections.objects) {
    labels.append(d.label);
    scores.push_back(d.score);
    headings.push_back(d.heading.value_or(kNone));
    const auto& b = d.space_box;
    boxes.push_back(b ? std::array<double, 7>{b->bottom_center.x(), b->bottom_center.y(),
                                              b->bottom_center.z(), b->length, b->width, b->height,
                                              b->yaw}
                      : std::array<double, 7>{kNone, kNone, kNone, kNone, kNone, kNone, kNone});
    const auto& i = d.image_box;
    image_boxes.push_back(i ? std::array<double, 4>{i->x1, i->y1, i->x2, i->y2}
                            : std::array<double, 4>{kNone, kNone, kNone, kNone});
  }
  const CameraModel& c = detections.camera;
  py::dict fields;
  fields["boxes"] = tableOf(boxes);
  fields["image_boxes"] = tableOf(image_boxes);
  fields["scores"] = arrayOf(scores);
  fields["labels"] = labels;
  fields["headings"] = arrayOf(headings);
  fields["camera"] = py::make_tuple(c.width, c.height, c.fx, c.fy, c.cx, c.cy);
  return fields;
}

py::dict fieldsOf(const CameraImage& image) {
  py::dict fields;
  const auto raster = image.load ? image.load() : std::nullopt;
  if (!raster) return fields;
  fields["pixels"] = py::array_t<std::uint8_t>({raster->height, raster->width, raster->channels},
                                               raster->pixels.data());
  return fields;
}

py::dict dataOf(const LogObservation& observation) {
  if (const auto& frame = observation.frame()) return arraysOf(*frame);
  py::dict fields;
  if (const auto pose = loggedPose(observation.get())) fields["pose"] = matrixOf(pose->T_world_ego);
  if (const auto number = frameNumber(observation.get())) fields["number"] = *number;
  return fields;
}

std::int64_t stampNs(const LogObservation& observation) {
  return toStamp(observation.get().timestamp).value_or(Stamp{}).ns;
}

}  // namespace

py::dict arraysOf(const SensorFrame& frame) {
  return std::visit([](const auto& data) { return fieldsOf(data); }, frame.data);
}

std::string kindOf(const SensorFrame& frame) {
  constexpr const char* kKinds[] = {"lidar", "boxes", "radar", "image"};
  return kKinds[frame.data.index()];
}

std::string LogObservation::kind() const {
  if (isImage(*observation_)) return "image";
  if (const auto& decoded = frame()) return kindOf(*decoded);
  if (loggedPose(*observation_)) return "pose";
  return frameNumber(*observation_) ? "frame" : "other";
}

const std::optional<SensorFrame>& LogObservation::frame() const {
  if (!decoded_) frame_ = frameFromObservation(*observation_);
  decoded_ = true;
  return frame_;
}

LogObservation LogIterator::next() {
  const std::lock_guard lock(mutex_);
  auto observation = reader_.next();
  if (observation) return LogObservation(std::move(observation));
  if (!reader_.isComplete()) throw DataError(reader_.endMessage());
  throw py::stop_iteration();
}

void addObservations(py::module_& module) {
  py::class_<LogObservation>(module, "Observation", "One entry of a log.")
      .def_property_readonly("kind", &LogObservation::kind,
                             "'lidar', 'boxes', 'radar', 'image', 'pose', 'frame' or 'other'")
      .def_property_readonly(
          "sensor", [](const LogObservation& o) { return o.get().sensorLabel; },
          "Label of the sensor, as in [sensor.LABEL]")
      .def_property_readonly(
          "stamp", [](const LogObservation& o) { return Stamp{stampNs(o)}.seconds(); },
          "[s] since 1970, to 0.2 us")
      .def_property_readonly("stamp_ns", &stampNs, "[ns] since 1970, exact; 0: no stamp")
      .def_property_readonly(
          "sensor_pose",
          [](const LogObservation& o) {
            mrpt::poses::CPose3D pose;
            o.get().getSensorPose(pose);
            return matrixOf(toPose3(pose));
          },
          "4x4: takes points of the sensor to the vehicle [m]")
      .def_property_readonly("data", &dataOf,
                             "dict of arrays, by kind:\n"
                             "lidar: xyz (n, 3) float32 [m] in the sensor frame, intensity [0, 1], "
                             "ring, time [s] after the stamp, echo, pulse_width [m], label, trust "
                             "(P(of a surface), in front ends); those that are not there are None\n"
                             "radar: targets (n, 5): range [m], bearing [rad], range rate [m/s], "
                             "amplitude [dB], elevation [rad]; NaN: not measured\n"
                             "boxes: boxes (n, 7): x, y, z of the bottom's centre, length, width, "
                             "height [m], yaw [rad], in the sensor frame; image_boxes (n, 4) "
                             "[px]; scores, labels, headings [rad], camera\n"
                             "image: pixels (rows, columns, channels) uint8, blue first\n"
                             "pose: pose 4x4, vehicle to world [m]\n"
                             "frame: number");
  py::class_<LogIterator>(module, "LogReader", "Iterates the observations of a rawlog.")
      .def(py::init([](const std::string& path) {
        registerPerceptionClasses();
        return std::make_unique<LogIterator>(path);
      }))
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &LogIterator::next, py::call_guard<py::gil_scoped_release>());
}

}  // namespace perception::python
