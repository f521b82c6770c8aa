#include <Python.h>

#include "lane_run.hpp"

// Python's own interface: pybind11's headers would take a quarter of the time that this takes to compile.
PyMODINIT_FUNC FPBM_LANE_INIT() {
  using namespace fpbm::bindings;
  static LaneCode code{kLanes,
                       {&run_in_lanes<fpbm::Position<2>>, &run_in_lanes<fpbm::Position<3>>, &run_in_lanes<fpbm::Pose>}};
  static PyModuleDef definition = {PyModuleDef_HEAD_INIT,
                                   FPBM_LANE_MODULE,
                                   "Motions side by side in the lanes of one kind of processor.",
                                   -1,
                                   nullptr,
                                   nullptr,
                                   nullptr,
                                   nullptr,
                                   nullptr};
  PyObject* module = PyModule_Create(&definition);
  if (module == nullptr) return nullptr;
  if (PyModule_AddObject(module, "code", PyCapsule_New(&code, "fpbm_cpp.LaneCode", nullptr)) != 0) {
    Py_DECREF(module);
    return nullptr;
  }
  return module;
}
