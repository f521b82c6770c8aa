#pragma once

#include <pybind11/pybind11.h>

namespace py = pybind11;

namespace fpbm::bindings {

void bind_model(py::module_& m);
void bind_dynamics(py::module_& m);
void bind_path(py::module_& m);
void bind_scheme(py::module_& m);
void bind_limits(py::module_& m);
void bind_clearance(py::module_& m);
void bind_sim(py::module_& m);
void bind_target_filter(py::module_& m);
void bind_stream(py::module_& m);
void bind_task(py::module_& m);
void bind_realtime(py::module_& m);
void bind_inverse(py::module_& m);

}  // namespace fpbm::bindings
