#include "libperception/python/TrackerBinding.h"

#include <mrpt/obs/CObservation.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/python/StreamTracker.h"
#include "libperception/python/arrays/Arrays.h"
#include "libperception/python/arrays/Detections.h"
#include "libperception/python/arrays/GeodeticPose.h"
#include "libperception/python/arrays/Observations.h"
#include "libperception/python/arrays/SceneArrays.h"
#include "libperception/python/extensions/Callback.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception::python {
namespace py = pybind11;
namespace {

using MaybeScene = std::optional<SceneView>;

/// The place in the arguments of pose().
struct GeodeticNumbers {
  std::optional<double> latitude, longitude, height, yaw;
  double pitch = 0, roll = 0;
  std::array<double, 3> antenna{};

  bool hasMore() const {
    return height || yaw || pitch != 0 || roll != 0 || antenna != std::array<double, 3>{};
  }
  GeodeticPose poseAt(Stamp stamp, const PoseUncertainty& uncertainty) const {
    return {stamp,      *latitude, *longitude, height,
            yaw,        pitch,     roll,       Vector3(antenna[0], antenna[1], antenna[2]),
            uncertainty};
  }
};

/// The tracker of the module: arrays in, scenes out. Python's lock is released while it computes.
class Tracker {
 public:
  Tracker(const std::string& ini, const std::vector<std::string>& settings,
          const std::string& output)
      : tracker_(ini, settings, output),
        places_(tracker_.ego()),
        classes_(std::make_shared<std::vector<std::string>>(tracker_.classNames())) {}

  void pose(const py::handle& stamp, const py::object& T, const GeodeticNumbers& place,
            const PoseUncertainty& uncertainty) {
    CallbackScope::refuse();
    if (!(uncertainty.sigma_xy >= 0 && uncertainty.sigma_yaw >= 0 && uncertainty.sigma_pitch >= 0))
      throw DataError("pose: a standard deviation is negative or NaN");
    const bool by_place = place.latitude && place.longitude;
    if (T.is_none() != by_place || place.latitude.has_value() != place.longitude.has_value() ||
        (!by_place && place.hasMore()))
      throw Error(ExitCode::kUsage, "pose: expected T, or latitude and longitude");
    std::shared_ptr<mrpt::obs::CObservation> observation;
    if (by_place) {
      observation = places_.observationOf(place.poseAt(stampOf(stamp), uncertainty));
    } else {
      EgoState ego;
      ego.stamp = stampOf(stamp);
      ego.T_world_ego = poseOf(T, "T");
      ego.uncertainty = uncertainty;
      observation = poseObservation(ego);
    }
    const py::gil_scoped_release others;
    tracker_.add(*observation);
  }

  void frame(const py::handle& stamp, std::int64_t number) {
    CallbackScope::refuse();
    const Stamp at = stampOf(stamp);
    const py::gil_scoped_release others;
    tracker_.add(*frameComment(at, number));
  }

  MaybeScene scan(const std::string& sensor, const py::handle& stamp, const py::handle& xyz,
                  const py::object& intensity, const py::object& ring, const py::object& time,
                  const py::object& sensor_pose, double max_range, const py::object& echo,
                  const py::object& pulse_width, const py::object& label) {
    if (!(max_range >= 0)) throw DataError("max_range: negative or NaN");
    tracker_.checkSensor(sensor, {"lidar"});
    // A scan has megabytes: its memory serves the next one, unless another thread's call has it.
    auto scan = last_scan_ ? std::move(last_scan_) : std::make_unique<CObservationLidarScan>();
    scan->sensorLabel = sensor;
    scan->timestamp = fromStamp(stampOf(stamp));
    scan->setSensorPose(
        toMrpt(sensor_pose.is_none() ? Pose3::Identity() : poseOf(sensor_pose, "sensor_pose")));
    readCloud(xyz, {intensity, ring, time, echo, pulse_width, label}, scan->cloud);
    scan->cloud.max_range = max_range;
    MaybeScene scene = addObservation(*scan);
    last_scan_ = std::move(scan);
    return scene;
  }

  MaybeScene boxes(const std::string& sensor, const py::handle& stamp, const py::handle& boxes,
                   const py::handle& scores, const std::vector<std::string>& labels,
                   const std::string& z, const py::object& sensor_pose) {
    if (z != "bottom" && z != "center")
      throw Error(ExitCode::kUsage, "z: expected 'bottom' or 'center' of the boxes");
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"positions"});
    frame.data = spaceBoxes(boxes, scores, labels, z == "center", "");
    return addFrame(frame);
  }

  MaybeScene imageBoxes(const std::string& sensor, const py::handle& stamp, const py::handle& boxes,
                        const py::handle& scores, const std::vector<std::string>& labels,
                        const CameraNumbers& camera, const py::object& headings,
                        const py::object& sensor_pose) {
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"boxes"});
    frame.data = imageBoxesOf(boxes, scores, labels, camera, headings);
    return addFrame(frame);
  }

  MaybeScene radar(const std::string& sensor, const py::handle& stamp, const py::object& range,
                   const py::object& bearing, const py::object& range_rate,
                   const py::object& amplitude, const py::object& elevation,
                   const py::object& sensor_pose, double max_range) {
    if (!(max_range >= 0)) throw DataError("max_range: negative or NaN");
    SensorFrame frame = frameOf(sensor, stamp, sensor_pose, {"radar"});
    frame.data = radarReturns({range, bearing, range_rate, amplitude, elevation}, max_range);
    return addFrame(frame);
  }

  MaybeScene add(const LogObservation& observation) { return addObservation(observation.get()); }

  std::vector<SceneView> pending() {
    CallbackScope::refuse();
    const py::gil_scoped_release others;
    return views(tracker_.takeAll());
  }

  std::vector<SceneView> finish() {
    CallbackScope::refuse();
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

  MaybeScene addFrame(const SensorFrame& frame) {
    std::shared_ptr<mrpt::obs::CObservation> observation;
    {
      const py::gil_scoped_release others;
      observation = observationFromFrame(frame);
    }
    return addObservation(*observation);
  }

  MaybeScene addObservation(const mrpt::obs::CObservation& observation) {
    CallbackScope::refuse();
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
  GeodeticPoses places_;
  std::shared_ptr<const std::vector<std::string>> classes_;
  std::unique_ptr<CObservationLidarScan> last_scan_;  ///< taken and given back under Python's lock
};

}  // namespace

void addTracker(py::module_& module) {
  const py::object none = py::none();
  py::class_<Tracker>(module, "Tracker")
      .def(py::init([](const std::string& ini, const std::vector<std::string>& settings,
                       const std::string& output) {
             const py::gil_scoped_release others;
             registerPerceptionClasses();
             const std::shared_lock reading(variantsMutex());
             return std::make_unique<Tracker>(ini, settings, output);
           }),
           py::arg("ini"), py::arg("settings"), py::arg("output"))
      .def(
          "pose",
          [](Tracker& t, const py::handle& stamp, const py::object& T,
             std::optional<double> latitude, std::optional<double> longitude,
             std::optional<double> height, std::optional<double> yaw, double pitch, double roll,
             const std::array<double, 3>& antenna, double sigma_xy, double sigma_yaw,
             double sigma_pitch) {
            t.pose(stamp, T, {latitude, longitude, height, yaw, pitch, roll, antenna},
                   {sigma_xy, sigma_yaw, sigma_pitch});
          },
          py::arg("stamp"), py::arg("T") = none, py::kw_only(), py::arg("latitude") = none,
          py::arg("longitude") = none, py::arg("height") = none, py::arg("yaw") = none,
          py::arg("pitch") = 0.0, py::arg("roll") = 0.0,
          py::arg("antenna") = std::array<double, 3>{}, py::arg("sigma_xy") = 0.0,
          py::arg("sigma_yaw") = 0.0, py::arg("sigma_pitch") = 0.0)
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
          "learned",
          [](const Tracker& t) {
            CallbackScope::refuse();
            return t.stream().learned();
          },
          py::call_guard<py::gil_scoped_release>())
      .def(
          "event_lines",
          [](const Tracker& t) {
            CallbackScope::refuse();
            return t.stream().eventLines();
          },
          py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("classes", &Tracker::classes)
      .def_property_readonly("sensors", [](const Tracker& t) { return t.stream().sensorLabels(); });
}

}  // namespace perception::python
