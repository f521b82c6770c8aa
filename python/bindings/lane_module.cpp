#include <Python.h>

#include "fpbm/core/lanes.hpp"
#include "lane_code.hpp"

// The C interface of Python, because the headers of pybind11 would take a quarter of the compile time.
PyMODINIT_FUNC FPBM_LANE_INIT() {
  using namespace fpbm::bindings;
  constexpr auto kLanes = static_cast<int>(std::experimental::native_simd<double>::size());
  static LaneCode code{
      kLanes, {plane_in_lanes(), position_in_lanes(), pose_in_lanes()}, {&postures_in_lanes<6>, &postures_in_lanes<7>}};
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
