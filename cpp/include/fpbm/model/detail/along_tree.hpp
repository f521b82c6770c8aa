#pragma once

#include <array>

#include "fpbm/core/detail/unrolled.hpp"
#include "fpbm/core/types.hpp"
#include "fpbm/linalg/detail/three.hpp"

namespace fpbm {

/// Branches of a tree. Link j + 1 is the link of joint j.
template <int Joints>
struct Branches {
  JointBits starts =
      0;                ///< Bits of the joints that start a branch: the link of the previous joint does not carry them.
  JointBits forks = 0;  ///< Bits of the joints whose links carry a joint that starts a branch.
  std::array<int, static_cast<std::size_t>(kCapacity<Joints>)> carriers{};  ///< Links that carry the joints.
};

/// Vectors of each link, in a pass over a tree, two joints at a time. A pass continues with the vectors of the previous
/// link, which a compiler keeps in registers. Vectors are stored only for links that carry branches.
///
/// Count: number of vectors of a link. kTree: false for a chain.
template <int Count, bool kTree, int Joints, typename Scalar>
class AlongTree {
 public:
  using Two = std::array<Three<Pair<Scalar>>, Count>;  ///< Vectors of two links.
  using One = std::array<Three<Scalar>, Count>;

  /// A pass from the base to the tips. start: vectors of the base.
  AlongTree(const Branches<Joints>& branches, const One& start) noexcept : branches_(branches), last_(start) {
    if constexpr (kTree) stored_[0] = start;
  }
  /// A pass from the tips to the base.
  explicit AlongTree(const Branches<Joints>& branches) noexcept : AlongTree(branches, zero()) {
    if constexpr (kTree) {
      each_joint(branches.forks, [&](Eigen::Index j) noexcept { stored(j + 1) = zero(); });
    }
  }

  /// The vectors of the links of joints i and i + 1: the vectors of their carriers, plus `own`.
  [[nodiscard, gnu::always_inline]] Two outward(Eigen::Index i, const Two& own) noexcept {
    if (is_between(i)) {
      const One a = sum(last_, first(own));
      last_ = sum(a, second(own));
      return both(a, last_);
    }
    const One a = sum(carrier(i), first(own));
    keep(i, a);
    const One b = sum(carrier(i + 1), second(own));
    keep(i + 1, b);
    return both(a, b);
  }
  /// The vectors of the carriers of joints i and i + 1. The vectors of the links of the joints are `own`.
  [[nodiscard, gnu::always_inline]] Two of_carriers(Eigen::Index i, const Two& own) noexcept {
    if (is_between(i)) {
      const One a = last_;
      last_ = second(own);
      return both(a, first(own));
    }
    const One a = carrier(i);
    keep(i, first(own));
    const One b = carrier(i + 1);
    keep(i + 1, second(own));
    return both(a, b);
  }
  /// In a pass toward the base: `own`, plus the sums over all links that the links of joints i and i + 1 carry.
  [[nodiscard, gnu::always_inline]] Two inward(Eigen::Index i, const Two& own) noexcept {
    if (is_between(i)) {
      Two result;
      for (std::size_t k = 0; k < Count; ++k) {
        result[k] = {onto(last_[k].x, own[k].x), onto(last_[k].y, own[k].y), onto(last_[k].z, own[k].z)};
      }
      return result;
    }
    const One b = sum(carried(i + 1), second(own));
    give(i + 1, b);
    const One a = sum(carried(i), first(own));
    give(i, a);
    return both(a, b);
  }

 private:
  template <typename Result, typename F>
  [[nodiscard, gnu::always_inline]] static Result by_vector(const F& f) noexcept {
    Result result;
    each(Constant<0>{}, Constant<Count>{}, [&](auto k) noexcept {
      constexpr auto kAt = static_cast<std::size_t>(decltype(k)::kIndex);
      result[kAt] = f(kAt);
    });
    return result;
  }
  [[nodiscard]] static One zero() noexcept {
    return by_vector<One>([](std::size_t) noexcept { return Three<Scalar>{Scalar(0), Scalar(0), Scalar(0)}; });
  }
  [[nodiscard, gnu::always_inline]] static One sum(const One& a, const One& b) noexcept {
    return by_vector<One>([&](std::size_t k) noexcept { return a[k] + b[k]; });
  }
  [[nodiscard, gnu::always_inline]] static One first(const Two& both) noexcept {
    return by_vector<One>([&](std::size_t k) noexcept { return fpbm::first(both[k]); });
  }
  [[nodiscard, gnu::always_inline]] static One second(const Two& both) noexcept {
    return by_vector<One>([&](std::size_t k) noexcept { return fpbm::second(both[k]); });
  }
  [[nodiscard, gnu::always_inline]] static Two both(const One& a, const One& b) noexcept {
    return by_vector<Two>([&](std::size_t k) noexcept -> Three<Pair<Scalar>> {
      return {{a[k].x, b[k].x}, {a[k].y, b[k].y}, {a[k].z, b[k].z}};
    });
  }

  /// Sums over two links and over all links beyond, whose sum is `last`: fewer operations than with separate entries.
  [[nodiscard, gnu::always_inline]] static Pair<Scalar> onto(Scalar& last, const Pair<Scalar>& own) noexcept {
    const Pair<Scalar> sums = own + Pair<Scalar>(own.second(), Scalar(0)) + Pair<Scalar>(last);
    last = sums.first();
    return sums;
  }

  /// Whether joints i and i + 1 are between two branches, as in a chain.
  [[nodiscard]] bool is_between(Eigen::Index i) const noexcept {
    return !kTree || ((branches_.starts | branches_.forks) >> i & 3U) == 0;
  }
  [[nodiscard]] bool starts(Eigen::Index j) const noexcept { return kTree && (branches_.starts >> j & 1U) != 0; }
  [[nodiscard]] bool forks(Eigen::Index j) const noexcept { return kTree && (branches_.forks >> j & 1U) != 0; }
  [[nodiscard]] One& stored(Eigen::Index link) noexcept { return stored_[static_cast<std::size_t>(link)]; }
  [[nodiscard]] One& stored_carrier(Eigen::Index j) noexcept {
    return stored(branches_.carriers[static_cast<std::size_t>(j)]);
  }

  [[nodiscard, gnu::always_inline]] One carrier(Eigen::Index j) noexcept {
    One result = last_;
    if (starts(j)) result = stored_carrier(j);
    return result;
  }
  [[gnu::always_inline]] void keep(Eigen::Index j, const One& value) noexcept {
    last_ = value;
    if (forks(j)) stored(j + 1) = value;
  }
  [[nodiscard, gnu::always_inline]] One carried(Eigen::Index j) noexcept {
    One result = last_;
    if (forks(j)) result = sum(result, stored(j + 1));
    return result;
  }
  [[gnu::always_inline]] void give(Eigen::Index j, const One& value) noexcept {
    last_ = value;
    if (!starts(j)) return;
    stored_carrier(j) = sum(stored_carrier(j), value);
    last_ = zero();
  }

  const Branches<Joints>& branches_;
  One last_;
  std::array<One, kTree ? static_cast<std::size_t>(kCapacity<Joints>) + 1 : 1> stored_;
};

}  // namespace fpbm
