#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/python/Programs.h"
#include "libperception/python/TrackerBinding.h"
#include "libperception/python/arrays/Observations.h"
#include "libperception/python/arrays/SceneArrays.h"
#include "libperception/python/extensions/Callback.h"
#include "libperception/python/extensions/Extensions.h"

namespace perception::python {
namespace py = pybind11;
namespace {

PyObject* error_type = nullptr;

/// Error with the program's exit code as `code`.
void raiseError(const Error& error) {
  const py::object raised = py::reinterpret_borrow<py::object>(error_type)(py::str(error.what()));
  raised.attr("code") = static_cast<int>(error.code());
  PyErr_SetObject(error_type, raised.ptr());
}

void rethrowCause(const std::exception_ptr& thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const CallbackFailure& failure) {
    std::rethrow_exception(failure.cause);
  }
}

void addErrors(py::module_& module) {
  error_type = PyErr_NewExceptionWithDoc(
      "perception.Error",
      "What the programs report as error. `code` is their exit code: 64 usage, 65 bad input, 66 no "
      "input, 73 output cannot be created, 74 failed midway, 78 bad configuration.",
      PyExc_RuntimeError, nullptr);
  if (error_type == nullptr) throw py::error_already_set();
  module.attr("Error") = py::reinterpret_borrow<py::object>(error_type);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      rethrowCause(thrown);
    } catch (const Error& error) {
      raiseError(error);
    } catch (py::error_already_set& error) {
      error.restore();
    }
  });
}

/// Ctrl-C is KeyboardInterrupt, as of Python's own loops.
int runInterruptible(const std::string& name, const std::vector<std::string>& arguments) {
  try {
    const py::gil_scoped_release others;
    return runProgram(name, arguments);
  } catch (const Error& error) {
    if (error.code() != ExitCode::kTryAgain || !stopAsked()) throw;
  }
  PyErr_SetNone(PyExc_KeyboardInterrupt);
  throw py::error_already_set();
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  addErrors(module);
  addObservations(module);
  addScene(module);
  addTracker(module);
  addExtensions(module);
  module.def("run_program", &runInterruptible, py::arg("name"), py::arg("arguments"),
             "Runs perception-NAME with these arguments; the number of its warnings.");
  module.attr("__version__") = PERCEPTION_VERSION;
}

}  // namespace perception::python
