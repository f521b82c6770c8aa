#include "tracker.hpp"

#include "fpbm/realtime/tracker.hpp"
#include "objectives.hpp"

namespace fpbm::bindings {
namespace {

template <typename Space, typename Scheme>
class Loop final : public LoopModel<Space> {
 public:
  using typename LoopModel<Space>::Result;
  using AnyTracker = Tracker<AnyArm<Space>, Space, Scheme>;

  explicit Loop(const AnyTracker& tracker) : tracker_(tracker) {}

  Result tick(const Reference<Space>& reference) override { return tracker_.tick(reference); }
  Result tick(AnyCourse<Space>& course) override { return tracker_.tick(course); }
  Result resolve_measured([[maybe_unused]] const State<kDynamic>& measured,
                          [[maybe_unused]] const Reference<Space>& reference) override {
    if constexpr (Scheme::kLevel == Level::kAcceleration) {
      return tracker_.resolve_measured(measured.q, measured.qd, reference);
    } else {
      throw std::invalid_argument("resolve_measured: a velocity-level scheme has no accelerations");
    }
  }
  void stop() override { tracker_.stop(); }
  void resume() override { tracker_.resume(); }
  [[nodiscard]] const State<kDynamic>& state() const override { return tracker_.state(); }
  [[nodiscard]] typename Space::template Point<double> tip() const override { return tracker_.tip(); }

 private:
  AnyTracker tracker_;
};

}  // namespace

template <typename Space>
std::shared_ptr<LoopModel<Space>> make_loop(const WholeArm<Space>& arm, PyScheme scheme, const State<kDynamic>& start,
                                            const TrackerOptions<>& options, const JointLimits<kDynamic>& limits) {
  if (scheme.singular.radius() == 0.0) scheme.singular = options.singular;
  return std::visit(
      [&](const auto& whole) -> std::shared_ptr<LoopModel<Space>> {
        using Scheme = std::decay_t<decltype(whole)>;
        using AnyLoopOf = Loop<Space, Scheme>;
        const Limits<Scheme::kLevel, kDynamic> kept(limits, options.dt);
        return std::make_shared<AnyLoopOf>(
            typename AnyLoopOf::AnyTracker({arm.model, arm.dof()}, Space{}, whole, start, options, kept));
      },
      whole_scheme(scheme, arm));
}

template std::shared_ptr<LoopModel<Position<2>>> make_loop(const WholeArm<Position<2>>&, PyScheme,
                                                           const State<kDynamic>&, const TrackerOptions<>&,
                                                           const JointLimits<kDynamic>&);
template std::shared_ptr<LoopModel<PlanarPose>> make_loop(const WholeArm<PlanarPose>&, PyScheme, const State<kDynamic>&,
                                                          const TrackerOptions<>&, const JointLimits<kDynamic>&);
template std::shared_ptr<LoopModel<Position<3>>> make_loop(const WholeArm<Position<3>>&, PyScheme,
                                                           const State<kDynamic>&, const TrackerOptions<>&,
                                                           const JointLimits<kDynamic>&);
template std::shared_ptr<LoopModel<Pose>> make_loop(const WholeArm<Pose>&, PyScheme, const State<kDynamic>&,
                                                    const TrackerOptions<>&, const JointLimits<kDynamic>&);

}  // namespace fpbm::bindings
