#pragma once

#include <cstdint>
#include <functional>

#include "fpbm/bound/clearance.hpp"
#include "fpbm/bound/speed_bounds.hpp"
#include "fpbm/bound/task_bounds.hpp"
#include "model.hpp"
#include "optional_torque_bounds.hpp"

namespace fpbm::bindings {

/// The bounds of a motion: the functions of fpbm::Bounds, compiled once, in bounds.cpp. Bounds that are not given are
/// empty.
class AnyBounds {
  using All = Bounds<Clearance<kDynamic>, TaskBounds<kDynamic>, SpeedBounds<kDynamic>, OptionalTorqueBounds>;

 public:
  static constexpr int kRows = All::kRows;

  AnyBounds(const Clearance<kDynamic>& clearance, const TaskBounds<kDynamic>& walls,
            const SpeedBounds<kDynamic>& speeds, const OptionalTorqueBounds& torques);
  AnyBounds(const AnyBounds& other);
  AnyBounds(AnyBounds&& other) noexcept;
  AnyBounds& operator=(const AnyBounds&) = delete;
  AnyBounds& operator=(AnyBounds&&) = delete;
  ~AnyBounds();

  [[nodiscard]] Clearance<kDynamic>& clearance() noexcept { return all_.get<Clearance<kDynamic>>(); }

  [[nodiscard]] bool empty() const noexcept { return all_.empty(); }
  [[nodiscard]] bool bounds_torques() const noexcept { return all_.bounds_torques(); }
  [[nodiscard]] double slower_stop(double fraction) const noexcept { return all_.slower_stop(fraction); }
  void require(const JointVector& q);
  template <Level kLevel>
  void require_limits(const Limits<kLevel, kDynamic>& limits) const;
  template <Level kLevel>
  [[nodiscard]] Rows<kDynamic, kRows> rows(const NextMotion<kLevel, kDynamic>& next) noexcept;
  template <Level kLevel>
  [[nodiscard]] bool accepts(const Limits<kLevel, kDynamic>& limits, const State<kDynamic>& from,
                             const Stop<kLevel, kDynamic>& stop) noexcept;
  void gaps(const JointVector& q, double range, const std::function<void(double, const JointVector&)>& f) noexcept;
  [[nodiscard]] double closeness(const JointVector& q, double range) noexcept;
  [[nodiscard]] double speed_ratio(const JointVector& q, const JointVector& qd) noexcept;
  void torque_ratios(const JointVector& q, const JointVector& qd, const JointVector& qdd,
                     const std::function<void(double)>& f) const;
  [[nodiscard]] Status status(std::uint64_t active) const noexcept { return all_.status(active); }
  [[nodiscard]] double near_distance_sum() const noexcept { return all_.near_distance_sum(); }
  [[nodiscard]] bool moves_away() const noexcept { return all_.moves_away(); }
  [[nodiscard]] JointVector away(const JointVector& q) noexcept;

 private:
  All all_;
};

}  // namespace fpbm::bindings
