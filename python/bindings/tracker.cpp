#include "tracker.hpp"

#include <stdexcept>

#include "fpbm/realtime/tracker.hpp"

namespace fpbm::bindings {
namespace {

/// AnyTracker at one level. Empty bounds take almost no time, so trackers without bounds need no separate code.
template <Level kLevel, typename Space>
class TrackerAt final : public AnyTracker<Space> {
 public:
  using typename AnyTracker<Space>::Point;
  using typename AnyTracker<Space>::Result;

  TrackerAt(const AnyScheme<kLevel, Space>& scheme, const TrackerStart<Space>& from)
      : tracker_(from.arm, Space{}, scheme, from.start, from.options,
                 Limits<kLevel, kDynamic>(from.limits, from.options.dt), from.qdd0, from.bounds) {}

  Result tick(const Reference<Space>& reference) noexcept override { return tracker_.tick(reference); }
  Result tick(AnyFollower<Space>& follower) noexcept override { return tracker_.tick(follower); }
  Result tick(TargetFilter<Space>& filter) noexcept override { return tracker_.tick(filter); }
  [[nodiscard]] Result resolve_measured(const State<kDynamic>& measured, const Reference<Space>& reference) override {
    if constexpr (kLevel == Level::kAcceleration) {
      return tracker_.resolve_measured(measured.q, measured.qd, reference);
    } else {
      throw std::invalid_argument("resolve_measured: the scheme is at velocity level: must be at acceleration level");
    }
  }

  void stop() noexcept override { tracker_.stop(); }
  void resume() noexcept override { tracker_.resume(); }

  [[nodiscard]] const AnyArmFor<Space>& arm() const noexcept override { return tracker_.arm(); }
  [[nodiscard]] const State<kDynamic>& state() const noexcept override { return tracker_.state(); }
  [[nodiscard]] const JointVector& acceleration() const noexcept override { return tracker_.acceleration(); }
  [[nodiscard]] const JointVector& acceleration_change() const noexcept override {
    return tracker_.acceleration_change();
  }
  [[nodiscard]] Point tip() const noexcept override { return tracker_.tip(); }
  [[nodiscard]] double sigma() const noexcept override { return tracker_.sigma(); }
  [[nodiscard]] Clearance<kDynamic>& clearance() noexcept override { return tracker_.bounds().clearance(); }

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
  Status advance(const TickReferences<Space>& references) noexcept override {
    return tracker_.advance(references).status;
  }

 private:
  Tracker<AnyArmFor<Space>, Space, AnyScheme<kLevel, Space>, AnyBounds> tracker_;
};

}  // namespace

template <typename Space>
std::unique_ptr<AnyTracker<Space>> make_tracker(const Scheme& scheme, const TrackerStart<Space>& from) {
  return std::visit(
      [&](const auto& any) -> std::unique_ptr<AnyTracker<Space>> {
        return std::make_unique<TrackerAt<std::decay_t<decltype(any)>::kLevel, Space>>(any, from);
      },
      scheme.make<Space>(from.arm));
}

template std::unique_ptr<AnyTracker<Position<2>>> make_tracker(const Scheme&, const TrackerStart<Position<2>>&);
template std::unique_ptr<AnyTracker<PlanarPose>> make_tracker(const Scheme&, const TrackerStart<PlanarPose>&);
template std::unique_ptr<AnyTracker<Position<3>>> make_tracker(const Scheme&, const TrackerStart<Position<3>>&);
template std::unique_ptr<AnyTracker<Pose>> make_tracker(const Scheme&, const TrackerStart<Pose>&);

}  // namespace fpbm::bindings
