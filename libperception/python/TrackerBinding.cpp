#include "libperception/python/TrackerBinding.h"

#include <mrpt/obs/CObservation.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/python/Arrays.h"
#include "libperception/python/Observations.h"
#include "libperception/python/SceneArrays.h"
#include "libperception/python/StreamTracker.h"
#include "libperception/sensors/ToObservation.h"
#include "libperception/sensors/registerClasses.h"

namespace perception::python {
namespace py = pybind11;
namespace {

using MaybeScene = std::optional<SceneView>;

/// The tracker of the module: arrays in, scenes out. Python's lock is released while it computes.
class Tracker {
 public:
  Tracker(const std::string& ini, const std::vector<std::string>& settings,
          const std::string& output)
      : tracker_(ini, settings, output),
        classes_(std::make_shared<std::vector<std::string>>(tracker_.classNames())) {}

  void pose(const py::handle& stamp, const py::handle& T, double sigma_xy, double sigma_yaw,
            double sigma_pitch) {
    EgoState ego;
    ego.stamp = stampOf(stamp);
    ego.T_world_ego = poseOf(T, "T");
    if (!(sigma_xy >= 0 && sigma_yaw >= 0 && sigma_pitch >= 0))
      throw DataError("pose: a standard deviation is negative or NaN");
    ego.uncertainty = {sigma_xy, sigma_yaw, sigma_pitch};
    const py::gil_scoped_release others;
    tracker_.add(*poseObservation(ego));
  }

  void frame(const py::handle& stamp, std::int64_t number) {
    const Stamp at = stampOf(stamp);
    const py::gil_scoped_release others;
    tracker_.add(*frameComment(at, number));
  }

  MaybeScene scan(const std::string& sensor, const py::handle& stamp, const py::handle& xyz,
                  const py::object& intensity, const py::object& ring, const py::object& time,
                  const py::object& sensor_pose, double max_range, const py::object& echo,
                  const py::object& pulse_width, const py::object& label) {
    if (!(max_range >= 0)) throw DataError("max_range: negative or NaN");
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"lidar"});
    LidarCloud cloud = cloudOf(xyz, {intensity, ring, time, echo, pulse_width, label});
    cloud.max_range = max_range;
    frame.data = std::move(cloud);
    return addFrame(frame);
  }

  MaybeScene boxes(const std::string& sensor, const py::handle& stamp, const py::handle& boxes,
                   const py::handle& scores, const std::vector<std::string>& labels,
                   const std::string& z, const py::object& sensor_pose) {
    if (z != "bottom" && z != "center")
      throw Error(ExitCode::kUsage, "z: expected 'bottom' or 'center' of the boxes");
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"positions"});
    const auto rows = numbersOf(boxes, "boxes", 7);
    ObjectDetections detections;
    detections.objects = scored(rows.shape(0), scores, labels);
    const auto cells = rows.unchecked<2>();
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
      ObjectDetection::SpaceBox box;
      box.length = cells(i, 3), box.width = cells(i, 4), box.height = cells(i, 5);
      box.bottom_center = {cells(i, 0), cells(i, 1),
                           cells(i, 2) - (z == "center" ? box.height / 2 : 0)};
      box.yaw = cells(i, 6);
      detections.objects[static_cast<std::size_t>(i)].space_box = box;
    }
    frame.data = std::move(detections);
    return addFrame(frame);
  }

  MaybeScene imageBoxes(const std::string& sensor, const py::handle& stamp, const py::handle& boxes,
                        const py::handle& scores, const std::vector<std::string>& labels,
                        const std::tuple<int, int, double, double, double, double>& camera,
                        const py::object& headings, const py::object& sensor_pose) {
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"boxes"});
    const auto rows = numbersOf(boxes, "boxes", 4);
    const py::ssize_t n = rows.shape(0);
    ObjectDetections detections;
    auto& [width, height, fx, fy, cx, cy] = camera;
    if (width <= 0 || height <= 0 || !(fx > 0) || !(fy > 0) || !std::isfinite(cx + cy))
      throw DataError("camera: expected (width, height, fx, fy, cx, cy) in pixels");
    detections.camera.width = width, detections.camera.height = height;
    detections.camera.fx = fx, detections.camera.fy = fy;
    detections.camera.cx = cx, detections.camera.cy = cy;
    detections.objects = scored(n, scores, labels);
    const auto cells = rows.unchecked<2>();
    std::optional<py::array_t<double>> angles;
    if (!headings.is_none()) angles = numbersOf(headings, "headings", 0, n);
    for (py::ssize_t i = 0; i < n; ++i) {
      ObjectDetection& object = detections.objects[static_cast<std::size_t>(i)];
      object.image_box = {cells(i, 0), cells(i, 1), cells(i, 2), cells(i, 3)};
      if (angles && !std::isnan(angles->data()[i])) object.heading = angles->data()[i];
    }
    frame.data = std::move(detections);
    return addFrame(frame);
  }

  MaybeScene radar(const std::string& sensor, const py::handle& stamp, const py::handle& range,
                   const py::handle& bearing, const py::object& range_rate,
                   const py::object& amplitude, const py::object& elevation,
                   const py::object& sensor_pose, double max_range) {
    if (!(max_range >= 0)) throw DataError("max_range: negative or NaN");
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"radar"});
    const auto ranges = numbersOf(range, "range", 0);
    const py::ssize_t n = ranges.shape(0);
    const auto bearings = numbersOf(bearing, "bearing", 0, n);
    const auto optional = [n](const py::object& array, const char* what) {
      std::optional<py::array_t<double>> numbers;
      if (!array.is_none()) numbers = numbersOf(array, what, 0, n);
      return numbers;
    };
    const auto rates = optional(range_rate, "range_rate");
    const auto amplitudes = optional(amplitude, "amplitude");
    const auto elevations = optional(elevation, "elevation");
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
    frame.data = std::move(returns);
    return addFrame(frame);
  }

  MaybeScene add(const LogObservation& observation) { return addObservation(observation.get()); }

  std::vector<SceneView> pending() {
    const py::gil_scoped_release others;
    return views(tracker_.takeAll());
  }

  std::vector<SceneView> finish() {
    const py::gil_scoped_release others;
    tracker_.finish();
    return views(tracker_.takeAll());
  }

  const std::vector<std::string>& classes() const { return *classes_; }
  const StreamTracker& stream() const { return tracker_; }

 private:
  SensorFrame frameOf(const std::string& sensor, const py::handle& stamp,
                      const py::object& sensor_pose, const std::vector<std::string>& kinds) const {
    tracker_.checkSensor(sensor, kinds);
    SensorFrame frame;
    frame.sensor = sensor;
    frame.stamp = stampOf(stamp);
    if (!sensor_pose.is_none()) frame.T_ego_sensor = poseOf(sensor_pose, "sensor_pose");
    return frame;
  }

  static std::vector<ObjectDetection> scored(py::ssize_t n, const py::handle& scores,
                                             const std::vector<std::string>& labels) {
    const auto numbers = numbersOf(scores, "scores", 0, n);
    if (static_cast<py::ssize_t>(labels.size()) != n)
      throw DataError("labels: " + std::to_string(labels.size()) + ", expected " +
                      std::to_string(n) + ", one a box");
    std::vector<ObjectDetection> objects(labels.size());
    for (std::size_t i = 0; i < objects.size(); ++i) {
      objects[i].label = labels[i];
      objects[i].score = numbers.data()[i];
    }
    return objects;
  }

  MaybeScene addFrame(const SensorFrame& frame) {
    std::shared_ptr<mrpt::obs::CObservation> observation;
    {
      const py::gil_scoped_release others;
      observation = observationFromFrame(frame);
    }
    return addObservation(*observation);
  }

  MaybeScene addObservation(const mrpt::obs::CObservation& observation) {
    const py::gil_scoped_release others;
    tracker_.add(observation);
    auto scene = tracker_.take();
    if (!scene) return std::nullopt;
    return SceneView(std::move(*scene), classes_);
  }

  std::vector<SceneView> views(std::vector<Scene> scenes) const {
    std::vector<SceneView> out;
    for (Scene& scene : scenes) out.emplace_back(std::move(scene), classes_);
    return out;
  }

  StreamTracker tracker_;
  std::shared_ptr<const std::vector<std::string>> classes_;
};

py::object orNone(const SceneView& view, double FreePath::*field) {
  return view.scene.path ? py::cast((*view.scene.path).*field) : py::none();
}

py::object orNone(const SceneView& view, bool FreePath::*field) {
  return view.scene.path ? py::cast((*view.scene.path).*field) : py::none();
}

void addScene(py::module_& module) {
  py::class_<SceneView>(module, "Scene", "The objects around the vehicle at one instant.")
      .def_property_readonly("objects", &SceneView::objects,
                             "Structured array, one record an object; fields in the type hints. "
                             "World frame, SI units.")
      .def_property_readonly("classes", &SceneView::classes,
                             "Names of the classes, in the order of class_probability")
      .def_property_readonly(
          "stamp", [](const SceneView& v) { return v.scene.stamp.seconds(); },
          "[s] since 1970, to 0.2 us")
      .def_property_readonly(
          "stamp_ns", [](const SceneView& v) { return v.scene.stamp.ns; }, "[ns] since 1970, exact")
      .def_property_readonly(
          "frame", [](const SceneView& v) { return v.scene.frame; },
          "The number that Tracker.frame() gave; -1: none")
      .def_property_readonly(
          "pose", [](const SceneView& v) { return matrixOf(v.scene.ego.T_world_ego); },
          "4x4: vehicle to world [m]")
      .def_property_readonly(
          "free_distance", [](const SceneView& v) { return orNone(v, &FreePath::distance); },
          "[m] seen and free on the way ahead; None: no grid, or no lidar scan lately")
      .def_property_readonly(
          "stop", [](const SceneView& v) { return orNone(v, &FreePath::stop); },
          "An obstacle is nearer than the vehicle can stop; None as of free_distance")
      .def_property_readonly(
          "safe_speed", [](const SceneView& v) { return orNone(v, &FreePath::safe_speed); },
          "[m/s] from which the vehicle stops within free_distance; None as of it")
      .def_property_readonly(
          "too_fast", [](const SceneView& v) { return orNone(v, &FreePath::too_fast); },
          "The vehicle drives faster than safe_speed; None as of free_distance")
      .def("__len__", [](const SceneView& v) { return v.scene.objects.size(); });
}

}  // namespace

void addTracker(py::module_& module) {
  addScene(module);
  const py::object none = py::none();
  py::class_<Tracker>(module, "Tracker")
      .def(py::init([](const std::string& ini, const std::vector<std::string>& settings,
                       const std::string& output) {
             const py::gil_scoped_release others;
             registerPerceptionClasses();
             return std::make_unique<Tracker>(ini, settings, output);
           }),
           py::arg("ini"), py::arg("settings"), py::arg("output"))
      .def("pose", &Tracker::pose, py::arg("stamp"), py::arg("T"), py::kw_only(),
           py::arg("sigma_xy") = 0.0, py::arg("sigma_yaw") = 0.0, py::arg("sigma_pitch") = 0.0)
      .def("frame", &Tracker::frame, py::arg("stamp"), py::arg("number"))
      .def("scan", &Tracker::scan, py::arg("sensor"), py::arg("stamp"), py::arg("xyz"),
           py::arg("intensity") = none, py::arg("ring") = none, py::arg("time") = none,
           py::kw_only(), py::arg("sensor_pose") = none, py::arg("max_range") = 0.0,
           py::arg("echo") = none, py::arg("pulse_width") = none, py::arg("label") = none)
      .def("boxes", &Tracker::boxes, py::arg("sensor"), py::arg("stamp"), py::arg("boxes"),
           py::arg("scores"), py::arg("labels"), py::kw_only(), py::arg("z"),
           py::arg("sensor_pose") = none)
      .def("image_boxes", &Tracker::imageBoxes, py::arg("sensor"), py::arg("stamp"),
           py::arg("boxes"), py::arg("scores"), py::arg("labels"), py::arg("camera"), py::kw_only(),
           py::arg("headings") = none, py::arg("sensor_pose") = none)
      .def("radar", &Tracker::radar, py::arg("sensor"), py::arg("stamp"), py::arg("range"),
           py::arg("bearing"), py::arg("range_rate") = none, py::kw_only(),
           py::arg("amplitude") = none, py::arg("elevation") = none, py::arg("sensor_pose") = none,
           py::arg("max_range") = 0.0)
      .def("add", &Tracker::add, py::arg("observation"))
      .def("pending", &Tracker::pending)
      .def("finish", &Tracker::finish)
      .def(
          "learned", [](const Tracker& t) { return t.stream().learned(); },
          py::call_guard<py::gil_scoped_release>())
      .def(
          "event_lines", [](const Tracker& t) { return t.stream().eventLines(); },
          py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("classes", &Tracker::classes)
      .def_property_readonly("sensors", [](const Tracker& t) { return t.stream().sensorLabels(); });
}

}  // namespace perception::python
