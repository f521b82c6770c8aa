#include <Python.h>

#include <memory>

#include "lane_run.hpp"

namespace fpbm::bindings {
namespace {

template <int N>
std::unique_ptr<PostureSolver<Pose>> postures_in_lanes(const Chain<>& chain, const InverseOptions<>& options,
                                                       const JointLimits<N>& limits) {
  // Four lanes, also where eight fit: the first attempt that reaches the target ends the search (make inverse).
  using Inverse = InverseKinematics<SerialArm<N>, Pose, fpbm::Lanes<4>>;
  return std::make_unique<PostureSolverOf<Inverse, Pose>>(Inverse(SerialArm<N>(chain), Pose{}, options, limits));
}

}  // namespace
}  // namespace fpbm::bindings

// The C interface of Python, because the headers of pybind11 would take a quarter of the compile time.
PyMODINIT_FUNC FPBM_LANE_INIT() {
  using namespace fpbm::bindings;
  static LaneCode code{kLanes,
                       {plane_in_lanes(), position_in_lanes(), &run_in_lanes<fpbm::Pose>},
                       {&postures_in_lanes<6>, &postures_in_lanes<7>}};
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
