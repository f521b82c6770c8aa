#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "fpbm/core/types.hpp"
#include "fpbm/realtime/detail/task_distance.hpp"

namespace fpbm {

/// Postures in which an arm executed the whole task, with tips as far apart as possible, for Recovery.
template <typename Space, int N, typename Scalar = double>
class PostureMemory {
 public:
  using JointVector = Vector<N, Scalar>;
  using Point = typename Space::template Point<Scalar>;
  using Distance = TaskDistance<Space, Scalar>;

  static constexpr int kPostures = 8;  ///< Remembered postures. For seven joints and a pose, the memory has 1.3 kB.

  /// Whether a posture differs from the last posture passed to remember() by more than kNewJoint in some joint.
  [[nodiscard]] bool is_new(const JointVector& q) const noexcept {
    if (count_ == 0) return true;
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      if (std::abs(q(i) - last_remembered_(i)) > kNewJoint) return true;
    }
    return false;
  }

  /// Remembers a posture in which the whole task is executed, and its tip, unless a remembered tip is within kSpread.
  /// If the memory is full, the posture replaces the older of the two postures whose tips are nearest to each other.
  /// length: the arm's characteristic length [m].
  [[gnu::cold, gnu::noinline]] void remember(const JointVector& q, const Point& tip, Scalar length) noexcept {
    last_remembered_ = q;
    for (int i = 0; i < count_; ++i) {
      if (Distance::between(memory_[i].tip, tip, length) < kSpread) return;
    }
    memory_[count_ < kPostures ? count_++ : most_crowded(length)] = {q, tip, ++age_};
  }

  struct Nearest {
    Scalar distance;  ///< Distance of the remembered tip; infinite if no posture is remembered.
    int index;
  };
  [[nodiscard]] Nearest nearest(const Point& target, Scalar length) const noexcept {
    Nearest found{std::numeric_limits<Scalar>::infinity(), 0};
    for (int i = 0; i < count_; ++i) {
      const Scalar distance = Distance::between(target, memory_[i].tip, length);
      if (distance < found.distance) found = {distance, i};
    }
    return found;
  }
  [[nodiscard]] const JointVector& posture(int index) const noexcept { return memory_[index].q; }

 private:
  // The values are not tuned. `fpbm_tests --gtest_filter='Recovery.brings*'` prints how many arms do not return.
  static constexpr Scalar kNewJoint = Scalar(0.1);  ///< Change of a joint that may move the tip by kSpread [rad or m].
  static constexpr Scalar kSpread = Scalar(0.05);   ///< Smallest distance of two remembered tips, as TaskDistance.

  struct Remembered {
    JointVector q;
    Point tip;
    std::int64_t age;
  };

  /// Index of the older of the two postures whose tips are nearest to each other.
  [[nodiscard]] int most_crowded(Scalar length) const noexcept {
    int index = 0;
    Scalar least = std::numeric_limits<Scalar>::infinity();
    for (int i = 1; i < count_; ++i) {
      for (int j = 0; j < i; ++j) {
        const Scalar distance = Distance::between(memory_[i].tip, memory_[j].tip, length);
        if (!(distance < least)) continue;
        least = distance;
        index = memory_[i].age < memory_[j].age ? i : j;
      }
    }
    return index;
  }

  Remembered memory_[kPostures]{};
  int count_ = 0;
  std::int64_t age_ = 0;
  JointVector last_remembered_;  ///< Last posture passed to remember().
};

}  // namespace fpbm
