#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/model/kinematics.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// One sample of a motion, which a rollout passes to its recorder.
template <typename Space, int N, typename Scalar = double>
struct Sample {
  int index;
  Number<Scalar> t;                            ///< [s]
  Vector<N, Scalar> q;                         ///< [rad], or [m] for a prismatic joint, also below
  Vector<N, Scalar> qd;                        ///< [rad/s]
  Vector<N, Scalar> qdd;                       ///< [rad/s²], zero at velocity level
  typename Space::template Point<Scalar> tip;  ///< f(q) [m, rad]
  Reference<Space, Scalar> reference;
  Vector<Space::kRows, Scalar> error;  ///< x ⊖ f(q) [m, rad]
  /// Task Jacobian at q; for a stack, of the first level.
  std::decay_t<decltype(first_rows(std::declval<const Kinematics<Space, N, Scalar>&>()))> J;
};

/// Recorder that writes samples row by row into buffers of the caller. Null buffers are skipped.
/// Buffers are row-major, with one row per sample: n columns for joint quantities, Space::kSize for points (a pose is a
/// 4 × 4 matrix row by row), Space::kRows for the error.
template <typename Space, int N, typename Scalar = double>
struct MotionBuffers {
  Scalar* t = nullptr;
  Scalar* q = nullptr;
  Scalar* qd = nullptr;
  Scalar* qdd = nullptr;
  Scalar* x = nullptr;
  Scalar* x_ref = nullptr;
  Scalar* error = nullptr;

  void operator()(const Sample<Space, N, Scalar>& sample) const noexcept {
    if (t != nullptr) t[sample.index] = sample.t;
    write(q, sample.index, sample.q);
    write(qd, sample.index, sample.qd);
    write(qdd, sample.index, sample.qdd);
    write_point(x, sample.index, sample.tip);
    write_point(x_ref, sample.index, sample.reference.x);
    write(error, sample.index, sample.error);
  }

 private:
  template <int Rows>
  static void write(Scalar* buffer, int index, const Vector<Rows, Scalar>& row) noexcept {
    if (buffer == nullptr) return;
    Scalar* out = buffer + static_cast<std::ptrdiff_t>(index) * row.size();
    for (Eigen::Index i = 0; i < row.size(); ++i) out[i] = row(i);
  }

  static void write_point(Scalar* buffer, int index, const typename Space::template Point<Scalar>& point) noexcept {
    if (buffer != nullptr) Space::store(point, buffer + static_cast<std::ptrdiff_t>(index) * Space::kSize);
  }
};

}  // namespace fpbm
