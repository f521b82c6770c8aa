#pragma once

#include <memory>

#include "fpbm/bound/torque_bounds.hpp"
#include "model.hpp"

namespace fpbm::bindings {

/// TorqueBounds, or no bounds, for arms without masses.
class OptionalTorqueBounds {
  using Own = TorqueBounds<kDynamic>;

 public:
  static constexpr int kRows = Own::kRows;
  static constexpr Status kStatus = Own::kStatus;

  OptionalTorqueBounds() = default;
  explicit OptionalTorqueBounds(const Own& own) : own_(std::make_unique<Own>(own)) {}
  OptionalTorqueBounds(const OptionalTorqueBounds& other)
      : own_(other.own_ == nullptr ? nullptr : std::make_unique<Own>(*other.own_)) {}
  OptionalTorqueBounds(OptionalTorqueBounds&& other) noexcept = default;
  OptionalTorqueBounds& operator=(const OptionalTorqueBounds&) = delete;
  OptionalTorqueBounds& operator=(OptionalTorqueBounds&&) = delete;
  ~OptionalTorqueBounds() = default;

  [[nodiscard]] bool empty() const noexcept { return own_ == nullptr; }
  void require(const JointVector& q) {
    if (own_ != nullptr) own_->require(q);
  }
  template <Level kLevel>
  void require_limits(const Limits<kLevel, kDynamic>& limits) const {
    own_->require_limits(limits);
  }
  template <Level kLevel, int P>
  void rows(const NextMotion<kLevel, kDynamic>& next, Rows<kDynamic, P>& rows) noexcept {
    own_->rows(next, rows);
  }
  template <Level kLevel>
  [[nodiscard]] bool accepts(const Limits<kLevel, kDynamic>& limits, const State<kDynamic>& from,
                             const Stop<kLevel, kDynamic>& stop) noexcept {
    return own_->accepts(limits, from, stop);
  }
  [[nodiscard]] double slower_stop(double fraction) const noexcept { return own_->slower_stop(fraction); }
  template <typename F>
  void gaps(const JointVector& q, double range, const F& f) noexcept {
    own_->gaps(q, range, f);
  }
  [[nodiscard]] const auto& models() const noexcept { return own_->models(); }
  [[nodiscard]] const auto& most() const noexcept { return own_->most(); }

 private:
  std::unique_ptr<Own> own_;
};

}  // namespace fpbm::bindings
