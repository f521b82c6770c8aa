#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "fpbm/core/level.hpp"
#include "fpbm/core/mask.hpp"
#include "fpbm/core/space.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/model/manipulability.hpp"
#include "fpbm/sim/motion.hpp"

namespace fpbm {

/// Key figures of a motion. For joint vectors, the largest absolute entry ‖·‖∞; max and peak are over time.
template <typename Scalar = double>
struct MotionSummary {
  Scalar max_error;              ///< Distance of the tip from its reference [m].
  Scalar max_orientation_error;  ///< Angle between the tip's orientation and its reference [rad]; 0 where it is free.
  Scalar peak_velocity;          ///< [rad/s], or [m/s] for a prismatic joint, as everywhere below
  Scalar final_velocity;
  Scalar peak_acceleration;  ///< [rad/s²]
  Scalar final_acceleration;
  Scalar manipulability;  ///< Least √det(JJᵀ) over time (Yoshikawa 1985).
};

/// A recorder that summarises a motion, sample by sample, without storing it.
///
/// At velocity level accelerations are finite differences of the velocities, central ones, one-sided at both ends. No
/// branch depends on the numbers, so that it works in lanes.
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

  /// Figures of the samples so far; without samples, zeros and a manipulability of infinity.
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
  static constexpr int kLinear = std::is_same_v<Space, PlanarPose> ? 2 : Space::kRows < 3 ? Space::kRows : 3;

  /// ‖a‖∞
  [[nodiscard]] static Scalar size(const Vector<N, Scalar>& a) noexcept {
    using std::abs;
    using std::max;
    Scalar result(0);
    for (Eigen::Index i = 0; i < a.size(); ++i) result = max(result, Scalar(abs(a(i))));
    return result;
  }

  /// The slope over the last two steps belongs to the sample between them, the slope over the last step to its end.
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
  Scalar least_ = Scalar(-std::numeric_limits<Number<Scalar>>::infinity());
  Number<Scalar> t_{0};
  Vector<N, Scalar> qd_;
  Vector<N, Scalar> qd_before_;
};

}  // namespace fpbm
