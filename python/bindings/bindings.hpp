#pragma once

#include <pybind11/pybind11.h>

namespace fpbm::bindings {

void bind_model(pybind11::module_& m);
void bind_task(pybind11::module_& m);
void bind_resolver(pybind11::module_& m);
void bind_sim(pybind11::module_& m);
void bind_sweep(pybind11::module_& m);
void bind_realtime(pybind11::module_& m);

}  // namespace fpbm::bindings
