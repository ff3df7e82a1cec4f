// The extension `_burnish`: the functions of run.h, and Errors as exceptions of burnish._errors. What users see is in burnish/__init__.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <exception>
#include <string>

#include "arrays.h"
#include "burnish/core/build_info.h"
#include "burnish/core/error.h"
#include "run.h"

namespace py = pybind11;

namespace {

// Names in messages may hold any bytes.
py::str shown(const std::string& message) { return burnish::text_of(message, "backslashreplace"); }

void translate(std::exception_ptr thrown) {  // NOLINT(performance-unnecessary-value-param): as pybind11 calls it
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const burnish::Error& error) {
    const py::object exception = py::module_::import("burnish._errors").attr("error_of")(burnish::name(error.code()), shown(error.what()), shown(error.hint()));
    PyErr_SetObject(py::type::handle_of(exception).ptr(), exception.ptr());
  }
}

}  // namespace

PYBIND11_MODULE(_burnish, module) {
  module.doc() = "The compiled part of burnish; use the functions of `burnish`.";
  module.attr("__version__") = burnish::build_info().version;
  py::register_exception_translator(&translate);
  module.def("clean_options", &burnish::clean_options);
  module.def("read", &burnish::read);
  module.def("write", &burnish::write);
  module.def("check", &burnish::check);
  module.def("clean", &burnish::clean);
  module.def("compare", &burnish::compare);
  module.def("signed_distance", &burnish::signed_distance);
}
