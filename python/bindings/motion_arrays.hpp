#pragma once

#include <pybind11/typing.h>

#include <type_traits>

#include "arrays.hpp"
#include "fpbm/sim/motion.hpp"

namespace fpbm::bindings {

using Array = py::array_t<double>;
/// t, q, qd, qdd, x, x_ref, error of a motion, one row a sample.
using Arrays = py::typing::Tuple<Array, Array, Array, Array, Array, Array, Array>;

/// Arrays for a motion of that many samples of n joints, and the buffers in them.
template <typename Space>
struct MotionArrays {
  MotionArrays(py::ssize_t samples, py::ssize_t n)
      : t(samples),
        q({samples, n}),
        qd({samples, n}),
        qdd({samples, n}),
        x(points(samples)),
        x_ref(points(samples)),
        error({samples, py::ssize_t{Space::kRows}}) {}

  [[nodiscard]] MotionBuffers<Space, Eigen::Dynamic> buffers() {
    return {t.mutable_data(), q.mutable_data(),     qd.mutable_data(),   qdd.mutable_data(),
            x.mutable_data(), x_ref.mutable_data(), error.mutable_data()};
  }
  [[nodiscard]] Arrays arrays() const { return py::make_tuple(t, q, qd, qdd, x, x_ref, error); }

 private:
  static Array points(py::ssize_t samples) {
    if constexpr (std::is_same_v<Space, Pose>) {
      return Array({samples, py::ssize_t{4}, py::ssize_t{4}});
    } else {
      return Array({samples, py::ssize_t{Space::kSize}});
    }
  }

  Array t;
  Array q;
  Array qd;
  Array qdd;
  Array x;
  Array x_ref;
  Array error;
};

}  // namespace fpbm::bindings
