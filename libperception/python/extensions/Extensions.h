#pragma once
#include <pybind11/pybind11.h>

namespace perception::python {

/// Frame, add_front_end and add_motion_model of the module: rows of the tables of
/// docs/extending.md that are written in Python.
void addExtensions(pybind11::module_& module);

}  // namespace perception::python
