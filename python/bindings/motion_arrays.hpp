#pragma once

#include <pybind11/typing.h>

#include <optional>
#include <tuple>
#include <type_traits>

#include "arrays.hpp"
#include "clearance.hpp"
#include "motion.hpp"

namespace fpbm::bindings {

/// t, q, qd, qdd, x, x_ref, error of a motion, one row a sample; then scale and saturated, of one within limits; then
/// clearance, of one that keeps clear of shapes.
using Arrays = py::typing::Tuple<Array, py::ellipsis>;

/// Arrays for a motion of that many samples of n joints.
template <typename Space>
struct MotionArrays {
  /// limited: whether the motion has a scale and saturated joints as well. clear: whether it has a clearance.
  MotionArrays(py::ssize_t samples, py::ssize_t n, bool limited, bool clear)
      : t(samples),
        q({samples, n}),
        qd({samples, n}),
        qdd({samples, n}),
        x(points(samples)),
        x_ref(points(samples)),
        error({samples, py::ssize_t{Space::kRows}}),
        scale(limited ? samples : 0),
        saturated({limited ? samples : 0, n}),
        clearance(clear ? samples : 0) {}

  [[nodiscard]] Output<Space> output() {
    return {{t.mutable_data(), q.mutable_data(), qd.mutable_data(), qdd.mutable_data(), x.mutable_data(),
             x_ref.mutable_data(), error.mutable_data()},
            scale.size() > 0 ? scale.mutable_data() : nullptr,
            saturated.size() > 0 ? saturated.mutable_data() : nullptr,
            clearance.size() > 0 ? clearance.mutable_data() : nullptr};
  }
  [[nodiscard]] Arrays all() const {
    py::tuple every = py::make_tuple(t, q, qd, qdd, x, x_ref, error);
    if (scale.size() > 0) every = every + py::make_tuple(scale, saturated);
    if (clearance.size() > 0) every = every + py::make_tuple(clearance);
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

 private:
  static Array points(py::ssize_t samples) {
    if constexpr (std::is_same_v<Space, Pose>) {
      return Array({samples, py::ssize_t{4}, py::ssize_t{4}});
    } else {
      return Array({samples, py::ssize_t{Space::kSize}});
    }
  }
};

/// limits, error_bound, integral_gain, integral_bound, stall_time, singular_radius, singular_brake, null_damping and
/// clearance of a motion that keeps limits.
using LimitedOptions = std::tuple<py::object, double, double, double, double, double, double, double, py::object>;

inline std::optional<Limited> limited_of(const std::optional<LimitedOptions>& given, const Arm& arm) {
  if (!given) return std::nullopt;
  const auto& [limits, error_bound, gain, bound, stall_time, radius, brake, damping, clearance] = *given;
  return Limited{limits.is_none() ? arm.limits() : joint_limits(limits),
                 {1e-3, error_bound, gain, bound, stall_time, SingularDamping<>(radius, brake), damping},
                 clearance_of(arm, clearance)};
}

/// Whether a motion is asked to keep clear of shapes.
inline bool keeps_clear(const std::optional<LimitedOptions>& given) {
  return given && !std::get<8>(*given).is_none();
}

}  // namespace fpbm::bindings
