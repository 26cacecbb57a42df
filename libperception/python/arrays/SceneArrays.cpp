#include "libperception/python/arrays/SceneArrays.h"

#include <cstdint>
#include <cstring>
#include <limits>

#include "libperception/measurement/Modality.h"

namespace perception::python {
namespace py = pybind11;
namespace {

/// Writes the fields of a packed record one after the other.
class RecordWriter {
 public:
  explicit RecordWriter(void* at) : at_(static_cast<char*>(at)) {}
  template <class Value>
  void put(Value value) {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  template <class Values>
  void putAll(const Values& values) {
    for (const double value : values) put(value);
  }
  void skip(std::size_t bytes) { at_ += bytes; }

 private:
  char* at_;
};

/// The class is filled by numpy from its number.
py::dtype recordOf(std::size_t classes, const py::dtype& class_name) {
  py::list fields;
  const auto add = [&](const char* name, const py::object& type) {
    fields.append(py::make_tuple(name, type));
  };
  const auto addMany = [&](const char* name, auto... counts) {
    fields.append(py::make_tuple(name, "f8", py::make_tuple(counts...)));
  };
  add("id", py::str("u8"));
  add("class", class_name);
  add("class_id", py::str("i4"));
  add("classified", py::str("?"));
  addMany("class_probability", classes);
  add("existence", py::str("f8"));
  addMany("position", 3);
  add("yaw", py::str("f8"));
  add("has_yaw", py::str("?"));
  add("p_front", py::str("f8"));
  addMany("velocity", 2);
  add("speed", py::str("f8"));
  addMany("size", 3);
  addMany("position_sd", 2);
  add("yaw_sd", py::str("f8"));
  add("speed_sd", py::str("f8"));
  addMany("covariance", 4, 4);
  add("yaw_variance", py::str("f8"));
  addMany("last_hit", modalities().size());
  return py::dtype::from_args(fields);
}

void putObject(const SceneObject& object, std::size_t name_bytes, RecordWriter record) {
  record.put(object.id);
  record.skip(name_bytes);
  record.put(static_cast<std::int32_t>(object.class_id));
  record.put(object.classified);
  record.putAll(object.class_probability);
  record.put(object.existence);
  record.putAll(object.position);
  record.put(object.yaw);
  record.put(object.has_yaw);
  record.put(object.p_front);
  record.putAll(object.velocity);
  record.put(object.speed);
  record.putAll(std::initializer_list<double>{object.length, object.width, object.height});
  record.putAll(
      std::initializer_list<double>{object.sd_x, object.sd_y, object.sd_yaw, object.sd_speed});
  record.putAll(object.covariance.reshaped());
  record.put(object.sd_yaw * object.sd_yaw);
  for (const ModalityRow& row : modalities()) {
    const auto hit = object.last_hit.find(row.letter);
    record.put(hit == object.last_hit.end() ? std::numeric_limits<double>::quiet_NaN()
                                            : hit->second.seconds());
  }
}

py::object orNone(const SceneView& view, double FreePath::*field) {
  return view.scene.path ? py::cast((*view.scene.path).*field) : py::none();
}

py::object orNone(const SceneView& view, bool FreePath::*field) {
  return view.scene.path ? py::cast((*view.scene.path).*field) : py::none();
}

}  // namespace

py::array SceneView::objects() const {
  const py::array names = py::module_::import("numpy").attr("array")(py::cast(*classes_));
  const py::dtype record = recordOf(classes_->size(), names.dtype());
  py::array objects(record,
                    std::vector<py::ssize_t>{static_cast<py::ssize_t>(scene.objects.size())});
  const auto name_bytes = static_cast<std::size_t>(names.dtype().itemsize());
  char* data = static_cast<char*>(objects.mutable_data());
  std::memset(data, 0, static_cast<std::size_t>(objects.nbytes()));
  for (const SceneObject& object : scene.objects) {
    putObject(object, name_bytes, RecordWriter(data));
    data += objects.itemsize();
  }
  if (objects.size() > 0)
    objects.attr("__setitem__")("class", names.attr("__getitem__")(objects["class_id"]));
  return objects;
}

void addScene(py::module_& module) {
  py::class_<SceneView>(module, "Scene", "The objects around the vehicle at one instant.")
      .def_property_readonly(
          "objects", &SceneView::objects,
          "Structured array, one record an object; all fields in the type hints. "
          "World frame, SI units, angles in radians.\n"
          "covariance (4, 4): of (x, y, vx, vy) in [m, m/s]: [:2, :2] of the "
          "position [m^2], [2:, 2:] of the velocity [m^2/s^2], [:2, 2:] between "
          "them [m^2/s]; the spread between the classes is part of it\n"
          "yaw_variance: of yaw [rad^2], at most pi^2: nothing is known of it\n"
          "p_front: probability that yaw points to the front and not to the "
          "back; .5: only the axis is known")
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

}  // namespace perception::python
