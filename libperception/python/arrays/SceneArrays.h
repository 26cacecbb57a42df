#pragma once
#include <pybind11/numpy.h>

#include <memory>
#include <string>
#include <vector>

#include "libperception/scene/Scene.h"

namespace perception::python {

/// A scene with the names of its classes, whose objects become an array when they are asked for.
class SceneView {
 public:
  SceneView(Scene scene, std::shared_ptr<const std::vector<std::string>> classes)
      : scene(std::move(scene)), classes_(std::move(classes)) {}

  /// One record an object; fields: perception/__init__.pyi.
  pybind11::array objects() const;
  const std::vector<std::string>& classes() const { return *classes_; }

  const Scene scene;

 private:
  std::shared_ptr<const std::vector<std::string>> classes_;
};

/// Scene of the module.
void addScene(pybind11::module_& module);

}  // namespace perception::python
