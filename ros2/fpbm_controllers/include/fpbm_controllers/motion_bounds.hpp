#pragma once

#include <fpbm/bound/task_bounds.hpp>
#include <fpbm/bound/torque_bounds.hpp>
#include <fpbm_controllers/nearest_pair.hpp>
#include <memory>
#include <stdexcept>

namespace fpbm_controllers {

using TaskBounds = fpbm::TaskBounds<Eigen::Dynamic>;
using TorqueBounds = fpbm::TorqueBounds<Eigen::Dynamic>;

/// A bound of a fpbm::Tracker, owned by SharedBounds. The loop may replace the bound between two ticks. Copies share
/// the bound: a tracker that starts again in the loop must not copy shapes, which allocate.
template <typename Bound>
class BoundView {
 public:
  static constexpr int kRows = Bound::kRows;
  static constexpr fpbm::Status kStatus = Bound::kStatus;

  explicit BoundView(const std::shared_ptr<Bound>& bound) noexcept : bound_(&bound) {}

  [[nodiscard]] bool empty() const noexcept { return *bound_ == nullptr || get().empty(); }
  /// Checks nothing, because a start in the loop must not throw. SharedBounds::require() checks the posture.
  template <typename Joints>
  void require(const Joints&) noexcept {}
  template <typename Next, typename Rows>
  void rows(const Next& next, Rows& rows) noexcept {
    get().rows(next, rows);
  }
  template <typename Limits, typename State, typename Stop>
  [[nodiscard]] bool accepts(const Limits& limits, const State& from, const Stop& stop) noexcept {
    return get().accepts(limits, from, stop);
  }
  template <typename Joints, typename F>
  void gaps(const Joints& q, double range, const F& f) noexcept {
    get().gaps(q, range, f);
  }

 protected:
  [[nodiscard]] Bound& get() const noexcept { return **bound_; }

 private:
  const std::shared_ptr<Bound>* bound_;
};

class ClearanceView : public BoundView<Clearance> {
 public:
  using BoundView::BoundView;
  [[nodiscard]] double near_distance_sum() const noexcept { return empty() ? 0.0 : get().near_distance_sum(); }
  [[nodiscard]] bool moves_away() const noexcept { return !empty() && get().moves_away(); }
  template <typename Joints>
  [[nodiscard]] Joints away(const Joints& q) noexcept {
    return get().away(q);
  }
};

class TorqueBoundsView : public BoundView<TorqueBounds> {
 public:
  using BoundView::BoundView;
  [[nodiscard]] double slower_stop(double fraction) const noexcept { return get().slower_stop(fraction); }
};

/// The bounds of a motion beyond the joint limits. Bounds that are not given are empty.
class SharedBounds {
 public:
  using Joints = fpbm::Vector<Eigen::Dynamic>;
  using View = fpbm::Bounds<ClearanceView, BoundView<TaskBounds>, TorqueBoundsView>;

  std::shared_ptr<Clearance> clearance;
  std::shared_ptr<TaskBounds> task_bounds;
  std::shared_ptr<TorqueBounds> torque_bounds;

  SharedBounds() = default;
  SharedBounds(const SharedBounds&) = delete;  // The views point to the members.
  SharedBounds& operator=(const SharedBounds&) = delete;

  [[nodiscard]] View view() const {
    return View(ClearanceView(clearance), BoundView<TaskBounds>(task_bounds), TorqueBoundsView(torque_bounds));
  }
  void reset() noexcept {
    clearance.reset();
    task_bounds.reset();
    torque_bounds.reset();
  }
  /// Whether the posture q keeps all bounds, so that a start at rest does not throw.
  [[nodiscard]] bool admit(const Joints& q) const noexcept { return view().closeness(q, kRoundOff) == 0.0; }
  /// Throws std::invalid_argument, which names the shapes, the link or the joint, if the posture q violates a bound.
  void require(const Joints& q) const {
    if (admit(q)) return;
    const auto pair = clearance ? nearest_pair(*clearance, q) : std::nullopt;
    if (pair && pair->is_too_close()) {
      throw std::invalid_argument(pair->too_close() +
                                  "move the arm, remove the obstacle, or add the pair to clearance.allowed");
    }
    if (task_bounds) task_bounds->require(q);
    if (torque_bounds) torque_bounds->require(q);
  }

 private:
  /// Larger than the round-off error of a gap, and smaller than the gap of an arm that has slid along a bound: at least
  /// 1e-6 m in the tests of obstacles [m, or a fraction of a torque].
  static constexpr double kRoundOff = 1e-9;
};

}  // namespace fpbm_controllers
