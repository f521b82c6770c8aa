#pragma once

#include <pybind11/pybind11.h>

namespace fpbm::bindings {

void bind_arm(pybind11::module_& m);
void bind_path(pybind11::module_& m);
void bind_scheme(pybind11::module_& m);
void bind_sim(pybind11::module_& m);
void bind_sweep(pybind11::module_& m);
void bind_realtime(pybind11::module_& m);

}  // namespace fpbm::bindings
