#pragma once

#include <pybind11/typing.h>

#include <optional>
#include <type_traits>

#include "arrays.hpp"
#include "motion.hpp"
#include "path.hpp"

namespace fpbm::bindings {

/// The arrays of a motion by name, one row per sample.
using Arrays = py::typing::Dict<py::str, py::array>;

/// Arrays for a motion of that many samples of n joints.
template <typename Space>
struct MotionArrays {
  MotionArrays(py::ssize_t samples, py::ssize_t n, const LimitOptions* limit_options, const StackOptions* stack)
      : t(samples),
        q({samples, n}),
        qd({samples, n}),
        qdd({samples, n}),
        x(points(samples)),
        x_ref(points(samples)),
        error({samples, py::ssize_t{Space::kRows}}) {
    if (limit_options != nullptr) {
      scale = Array(samples);
      saturated = py::array_t<bool>({samples, n});
      if (limit_options->keeps_clear) clearance = Array(samples);
      if (stack != nullptr) scales = Array({samples, py::ssize_t{stack->plan.levels}});
    }
    if (stack != nullptr) task_errors = Array({samples, py::ssize_t{stack->plan.error_size()}});
  }

  [[nodiscard]] Output<Space> output() {
    return {{t.mutable_data(), q.mutable_data(), qd.mutable_data(), qdd.mutable_data(), x.mutable_data(),
             x_ref.mutable_data(), error.mutable_data()},
            scale.size() > 0 ? scale.mutable_data() : nullptr,
            saturated.size() > 0 ? saturated.mutable_data() : nullptr,
            clearance.size() > 0 ? clearance.mutable_data() : nullptr,
            scales.size() > 0 ? scales.mutable_data() : nullptr,
            task_errors.size() > 0 ? task_errors.mutable_data() : nullptr};
  }
  [[nodiscard]] Arrays all() const {
    Arrays every;
    const auto put = [&](const char* name, const py::array& array) {
      if (array.size() > 0) every[name] = array;
    };
    put("t", t);
    put("q", q);
    put("qd", qd);
    put("qdd", qdd);
    put("x", x);
    put("x_ref", x_ref);
    put("error", error);
    put("scale", scale);
    put("saturated", saturated);
    put("clearance", clearance);
    put("scales", scales);
    put("task_errors", task_errors);
    return every;
  }

  Array t;
  Array q;
  Array qd;
  Array qdd;
  Array x;
  Array x_ref;
  Array error;
  Array scale;
  py::array_t<bool> saturated;
  Array clearance;
  Array scales;
  Array task_errors;

 private:
  static Array points(py::ssize_t samples) {
    if constexpr (std::is_same_v<Space, Pose>) {
      return Array({samples, py::ssize_t{4}, py::ssize_t{4}});
    } else {
      return Array({samples, py::ssize_t{Space::kSize}});
    }
  }
};

/// Duration of the path, or of the longest path [s].
inline double duration_of(const Path& path, const StackOptions* stack) {
  return stack != nullptr ? stack->duration : path.duration();
}

/// Limit options from a LimitOptions of motion/simulation.py, or none.
std::optional<LimitOptions> limit_options_of(const py::object& given, const Model& model);

/// The tasks of a stack from a StackTasks of motion/simulation.py, or none. path: the path of the task with the name
/// given.task.
std::optional<StackOptions> stack_options_of(const py::object& given, const Model& model, const Path& path);

/// The address of a value, or null.
template <typename Value>
[[nodiscard]] const Value* pointer_to(const std::optional<Value>& value) noexcept {
  return value ? &*value : nullptr;
}

}  // namespace fpbm::bindings
