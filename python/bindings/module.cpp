#include <algorithm>
#include <string>

#include "bindings.hpp"
#include "fpbm/bound/detail/too_close.hpp"
#include "fpbm/core/detail/validation.hpp"

namespace {

/// A message whose remedy is in the notation of Python.
std::string in_python(std::string message) {
  const std::string remedy = ": give a bound";
  const std::size_t at = message.size() - std::min(remedy.size(), message.size());
  if (message.find("limits.acceleration[") != std::string::npos && message.compare(at, remedy.size(), remedy) == 0) {
    message.replace(at, remedy.size(), ": give limits=fp.JointLimits(acceleration=10), in rad/s^2 or m/s^2");
  }
  return message;
}

/// Translates a ParameterError to the ParameterError of the package, a subclass of ValueError.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const fpbm::TooClose& error) {  // The message has the remedies in the notation of Python.
    const py::object type = py::module_::import("fpbm_cpp.errors").attr("ParameterError");
    const std::string pair = py::repr(py::make_tuple(error.names().first, error.names().second));
    const std::string text =
        fpbm::TooClose::text(error.names(), error.value(), error.margin(), "allowed=[" + pair + "]");
    py::set_error(type, type(error.name(), py::none(), error.value(), text));
  } catch (const fpbm::ParameterError& error) {
    const py::object type = py::module_::import("fpbm_cpp.errors").attr("ParameterError");
    const py::object index = error.index() < 0 ? py::object(py::none()) : py::int_(error.index());
    const py::object value = std::isnan(error.value()) ? py::object(py::none()) : py::float_(error.value());
    py::set_error(type, type(error.name(), index, value, in_python(error.what())));
  }
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "The compiled part of fpbm_cpp.";
  m.attr("__version__") = FPBM_VERSION;
  py::register_local_exception_translator(&translate);
  using namespace fpbm::bindings;
  for (auto* const bind : {bind_model, bind_dynamics, bind_path, bind_scheme, bind_clearance, bind_sim, bind_limits,
                           bind_target_filter, bind_stream, bind_task, bind_realtime, bind_inverse}) {
    bind(m);
  }
}
