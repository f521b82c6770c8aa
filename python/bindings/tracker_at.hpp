#pragma once

#include <stdexcept>

#include "fpbm/realtime/tracker.hpp"
#include "tracker.hpp"

namespace fpbm::bindings {

/// AnyTracker under a scheme. Empty bounds take almost no time, so trackers without bounds need no separate code.
template <typename Scheme_, typename Space>
class TrackerAt final : public AnyTracker<Space> {
  static constexpr Level kLevel = Scheme_::kLevel;
  static constexpr bool kIsStack = kIsProduct<Space>;

 public:
  using typename AnyTracker<Space>::Point;
  using typename AnyTracker<Space>::Result;

  TrackerAt(const typename TrackedArm<Space>::type& arm, const Scheme_& scheme, const TrackerStart& from)
      : AnyTracker<Space>(from.options.dt, kLevel),
        tracker_(arm, Space{}, scheme, from.start, from.options, Limits<kLevel, kDynamic>(from.limits, from.options.dt),
                 from.qdd0, from.bounds) {}

  Result advance(const PathReferences<Space>& references) noexcept override { return tracker_.advance(references); }
  void approach(const State<kDynamic>& planned) noexcept override { tracker_.approach(planned); }
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) override {
    if constexpr (kLevel == Level::kAcceleration) {
      return tracker_.resolve_measured(measured.q, measured.qd, reference);
    } else {
      throw std::invalid_argument("resolve_measured: the scheme is at velocity level: must be at acceleration level");
    }
  }

  bool enable([[maybe_unused]] int level, [[maybe_unused]] bool on) noexcept override {
    if constexpr (kIsStack) return tracker_.enable(level, on);
    return false;
  }
  bool reorder([[maybe_unused]] const std::array<int, AnyStack::kLevels>& order) noexcept override {
    if constexpr (kIsStack) return tracker_.reorder(order);
    return false;
  }
  void stop() noexcept override {
    this->stopping_ = true;
    tracker_.stop();
  }
  void resume() noexcept override {
    this->stopping_ = false;
    tracker_.resume();
  }

  [[nodiscard]] const typename TrackedArm<Space>::type& arm() const noexcept override { return tracker_.arm(); }
  [[nodiscard]] const State<kDynamic>& state() const noexcept override { return tracker_.state(); }
  [[nodiscard]] const JointVector& acceleration() const noexcept override { return tracker_.acceleration(); }
  [[nodiscard]] const JointVector& acceleration_change() const noexcept override {
    return tracker_.acceleration_change();
  }
  [[nodiscard]] Point tip() const noexcept override { return tracker_.tip(); }
  [[nodiscard]] double sigma() const noexcept override { return tracker_.sigma(); }
  [[nodiscard]] AnyBounds& bounds() noexcept override { return tracker_.bounds(); }

  bool begin(const Vector<Space::kRows>& error, double length) noexcept override {
    return tracker_.begin(error, length);
  }
  [[nodiscard]] Reference<Space> corrected(const Reference<Space>& reference) const noexcept override {
    return tracker_.corrected(reference);
  }
  Status finish(const Reference<Space>& now, const TickReferences<Space>& references,
                const JointVector& u) noexcept override {
    return tracker_.finish(now, references, u);
  }

 private:
  Tracker<typename TrackedArm<Space>::type, Space, Scheme_, AnyBounds> tracker_;
};

}  // namespace fpbm::bindings
