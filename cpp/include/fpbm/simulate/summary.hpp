#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "fpbm/core/detail/mask.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/geometry/space.hpp"
#include "fpbm/model/manipulability.hpp"
#include "fpbm/simulate/detail/motion.hpp"

namespace fpbm {

/// Key figures of a motion. Velocities and accelerations are the largest absolute entry ‖·‖∞ of joint vectors. max and
/// peak are over time.
template <typename Scalar = double>
struct MotionSummary {
  Scalar max_error;              ///< Distance between the tip and its reference [m].
  Scalar max_orientation_error;  ///< Angle between tip and reference orientation [rad]; 0 if the task has no angles.
  Scalar peak_velocity;          ///< [rad/s], or [m/s] for a prismatic joint, also below
  Scalar final_velocity;
  Scalar peak_acceleration;  ///< [rad/s²]
  Scalar final_acceleration;
  Scalar manipulability;  ///< Smallest √det(JJᵀ) over time (Yoshikawa 1985).
};

/// Recorder that computes the key figures sample by sample, without storing the motion.
///
/// At velocity level, accelerations are finite differences of the velocities: central differences, and one-sided
/// differences at both ends. For lanes, no branch depends on the numbers.
template <typename Space, int N, typename Scalar = double>
class Summary {
 public:
  explicit Summary(Level level) noexcept : level_(level) {}

  void operator()(const Sample<Space, N, Scalar>& sample) noexcept {
    using std::max;
    constexpr int kAngular = Space::kRows - kLinear;
    square_ = max(square_, Scalar(sample.error.template head<kLinear>().squaredNorm()));
    if constexpr (kAngular > 0) {
      angular_square_ = max(angular_square_, Scalar(sample.error.template tail<kAngular>().squaredNorm()));
    }
    velocity_ = size(sample.qd);
    peak_velocity_ = max(peak_velocity_, velocity_);
    if (level_ == Level::kAcceleration) {
      acceleration_ = size(sample.qdd);
      peak_acceleration_ = max(peak_acceleration_, acceleration_);
    } else {
      differentiate(sample);
    }
    least_ = max(least_, Scalar(-manipulability(sample.J)));
  }

  /// Key figures of the samples so far. Without samples, zeros and an infinite manipulability.
  [[nodiscard]] MotionSummary<Scalar> result() const noexcept {
    using std::max;
    using std::sqrt;
    return {sqrt(square_),
            sqrt(angular_square_),
            peak_velocity_,
            velocity_,
            max(peak_acceleration_, acceleration_),
            acceleration_,
            -least_};
  }

 private:
  /// Number of linear rows of the error: 2 for a planar pose, otherwise at most 3.
  static constexpr int kLinear = std::is_same_v<Space, PlanarPose> ? 2 : Space::kRows < 3 ? Space::kRows : 3;

  /// ‖a‖∞
  [[nodiscard]] static Scalar size(const Vector<N, Scalar>& a) noexcept {
    using std::abs;
    using std::max;
    Scalar result(0);
    for (Eigen::Index i = 0; i < a.size(); ++i) result = max(result, Scalar(abs(a(i))));
    return result;
  }

  /// Accelerations as finite differences. The central difference over the last two steps is the acceleration of the
  /// previous sample. The difference over the first step is the acceleration of the first sample. The difference over
  /// the last step is the acceleration of the last sample, which result() adds to the peak.
  void differentiate(const Sample<Space, N, Scalar>& sample) noexcept {
    using std::max;
    if (sample.index > 0) {
      const Number<Scalar> h = sample.t - t_;
      acceleration_ = size((sample.qd - qd_) / Scalar(h));
      const Scalar inner = sample.index > 1 ? size((sample.qd - qd_before_) / Scalar(h + h)) : acceleration_;
      peak_acceleration_ = max(peak_acceleration_, inner);
    }
    qd_before_ = sample.index > 0 ? qd_ : sample.qd;
    qd_ = sample.qd;
    t_ = sample.t;
  }

  Level level_;
  Scalar square_{0};
  Scalar angular_square_{0};
  Scalar velocity_{0};
  Scalar peak_velocity_{0};
  Scalar acceleration_{0};
  Scalar peak_acceleration_{0};
  /// Minus the smallest manipulability, which max() updates without a branch.
  Scalar least_ = Scalar(-std::numeric_limits<Number<Scalar>>::infinity());
  Number<Scalar> t_{0};
  Vector<N, Scalar> qd_;
  Vector<N, Scalar> qd_before_;
};

}  // namespace fpbm
