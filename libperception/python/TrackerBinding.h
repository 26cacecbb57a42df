#pragma once
#include <pybind11/pybind11.h>

namespace perception::python {

/// Tracker and Scene of the module.
void addTracker(pybind11::module_& module);

}  // namespace perception::python
