#include "libperception/python/extensions/Extensions.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <exception>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>

#include "libperception/core/Error.h"
#include "libperception/python/arrays/Arrays.h"
#include "libperception/python/arrays/Detections.h"
#include "libperception/python/arrays/Observations.h"
#include "libperception/python/extensions/Callback.h"
#include "libperception/python/extensions/FunctionFrontEnd.h"
#include "libperception/python/extensions/FunctionMotion.h"

namespace perception::python {
namespace py = pybind11;
namespace {

/// A frame as a front end in Python gets it; it may be kept.
class FrameView {
 public:
  explicit FrameView(const SensorFrame& frame)
      : frame_(std::make_shared<const SensorFrame>(frame)) {}
  const SensorFrame& get() const { return *frame_; }

 private:
  std::shared_ptr<const SensorFrame> frame_;
};

/// Numbers of one shape that are finite; DataError that begins with `owner`.
template <class Matrix>
Matrix finiteOf(const py::handle& object, const std::string& what) {
  constexpr int kColumns = Matrix::ColsAtCompileTime == 1 ? 0 : Matrix::ColsAtCompileTime;
  const auto numbers = numbersOf(object, what, kColumns, Matrix::RowsAtCompileTime);
  Matrix matrix;
  for (int i = 0; i < matrix.size(); ++i)
    matrix(i / matrix.cols(), i % matrix.cols()) = numbers.data()[i];
  if (!matrix.allFinite()) throw DataError(what + ": values that are not finite");
  return matrix;
}

/// The function stays for good: pipelines that call it may outlive every name that it has.
py::handle kept(const py::object& function, const std::string& what) {
  if (PyCallable_Check(function.ptr()) == 0)
    throw Error(ExitCode::kUsage, what + ": expected a function");
  py::object mine = function;
  return mine.release();
}

/// What `call` returns. Exceptions come out as CallbackFailure; Python's lock is held.
template <class Call>
auto calledBack(const Call& call) {
  const py::gil_scoped_acquire python;
  const CallbackScope within;
  try {
    return call();
  } catch (...) {
    throw CallbackFailure{std::current_exception()};
  }
}

DetectFunction detectBy(const py::handle& function, const std::string& kind) {
  return [function, owner = "front end '" + kind + "': "](const SensorFrame& frame) {
    return calledBack([&] { return returnedBoxes(function(FrameView(frame)), owner); });
  };
}

MotionPrediction predictionOf(const py::object& returned, const std::string& owner) {
  if (!py::isinstance<py::tuple>(returned) || py::len(returned) != 3)
    throw DataError(owner + "expected (x, F, Q)");
  const auto parts = py::reinterpret_borrow<py::tuple>(returned);
  return {finiteOf<Vector4>(parts[0], owner + "x"), finiteOf<Matrix4>(parts[1], owner + "F"),
          finiteOf<Matrix4>(parts[2], owner + "Q")};
}

MotionFunction predictBy(const py::handle& function, const std::string& name) {
  return
      [function, owner = "motion model '" + name + "': "](const Vector4& x, double dt, double psd) {
        return calledBack([&] {
          return predictionOf(function(py::array_t<double>(4, x.data()), dt, psd), owner);
        });
      };
}

/// Waits for configurations that are being read, without Python's lock.
template <class Add>
void addAlone(const Add& add) {
  CallbackScope::refuse();
  const py::gil_scoped_release others;
  const std::unique_lock writing(variantsMutex());
  add();
}

void addFrame(py::module_& module) {
  py::class_<FrameView>(module, "Frame", "What a front end written in Python gets.")
      .def_property_readonly(
          "kind", [](const FrameView& v) { return kindOf(v.get()); },
          "'lidar', 'boxes', 'radar' or 'image'")
      .def_property_readonly(
          "sensor", [](const FrameView& v) { return v.get().sensor; },
          "Label of the sensor, as in [sensor.LABEL]")
      .def_property_readonly(
          "stamp", [](const FrameView& v) { return v.get().stamp.seconds(); },
          "[s] since 1970, to 0.2 us")
      .def_property_readonly(
          "stamp_ns", [](const FrameView& v) { return v.get().stamp.ns; }, "[ns] since 1970, exact")
      .def_property_readonly(
          "pose", [](const FrameView& v) { return matrixOf(v.get().ego.T_world_ego); },
          "4x4: takes points of the vehicle to the world [m]")
      .def_property_readonly(
          "sensor_pose", [](const FrameView& v) { return matrixOf(v.get().T_ego_sensor); },
          "4x4: takes points of the sensor to the vehicle [m]")
      .def_property_readonly(
          "ground",
          [](const FrameView& v) {
            const GroundPlane& g = v.get().ground;
            return py::make_tuple(g.a, g.b, g.c);
          },
          "(a, b, c): height of the ground a x + b y + c [m] in the vehicle frame")
      .def_property_readonly(
          "data", [](const FrameView& v) { return arraysOf(v.get()); },
          "dict of arrays, as Observation.data");
}

}  // namespace

void addExtensions(py::module_& module) {
  addFrame(module);
  module.def(
      "add_front_end",
      [](const std::string& kind, const py::object& function) {
        const DetectFunction detect = detectBy(kept(function, "front_end"), kind);
        addAlone([&] { addFrontEnd(kind, detect); });
      },
      py::arg("kind"), py::arg("function"));
  module.def(
      "add_motion_model",
      [](const std::string& name, const py::object& function, bool has_heading) {
        const MotionFunction predict = predictBy(kept(function, "motion_model"), name);
        addAlone([&] { addMotionModel(name, has_heading, predict); });
      },
      py::arg("name"), py::arg("function"), py::arg("has_heading"));
}

}  // namespace perception::python
