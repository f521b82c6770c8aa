#include "bindings.hpp"

PYBIND11_MODULE(_core, m) {
  m.doc() = "The compiled part of fpbm_cpp.";
  m.attr("__version__") = FPBM_VERSION;
  fpbm::bindings::bind_model(m);
  fpbm::bindings::bind_task(m);
  fpbm::bindings::bind_resolver(m);
  fpbm::bindings::bind_sim(m);
  fpbm::bindings::bind_sweep(m);
  fpbm::bindings::bind_realtime(m);
}
