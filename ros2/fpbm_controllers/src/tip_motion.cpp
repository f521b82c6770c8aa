#include <fpbm/model/coupled_arm.hpp>
#include <fpbm/realtime/tracker.hpp>
#include <fpbm/scheme/schemes.hpp>
#include <fpbm/target/target_filter.hpp>
#include <stdexcept>

#include "fpbm_controllers/description.hpp"
#include "fpbm_controllers/motion.hpp"

namespace fpbm_controllers {

namespace {

constexpr int kDof = Eigen::Dynamic;  // One instantiation serves arms of any number of joints.
using Arm = fpbm::CoupledArm<kDof>;
using Scheme = fpbm::AccelerationScheme<kDof>;

[[nodiscard]] Arm arm_to(const fpbm::Tree<>& tree, const fpbm::LinkFrame<>& tip) {
  fpbm::Chain<> chain = chain_to(tree, tip.link());
  chain.tip = tip.offset();
  return Arm(chain);
}

class TipMotion final : public Motion {
 public:
  explicit TipMotion(const MotionSettings& settings)
      : scheme_(settings.scheme),
        gains_(settings.tasks.at(0).gains),
        options_(settings.options),
        limits_(settings.limits),
        arm_(arm_to(settings.tree, settings.tasks[0].frame)),
        bounds_(settings.bounds),
        filter_(fpbm::Transform<>{}, settings.target, settings.filter) {
    try {
      fpbm::require_stable(scheme_from(Joints::Zero(arm_.dof())), fpbm::TickOfGains<>{options_.dt, 0.0});
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(settings.tasks[0].gains_of + error.what());
    }
  }

  void begin(const Joints& q, const Joints& rest) override {
    const fpbm::State<kDof> start{q, Joints::Zero(q.size())};
    tracker_.emplace(arm_, fpbm::Pose{}, scheme_from(rest), start, options_, limits_, start.qd, bounds_);
    (void)filter_.reset(tracker_->tip());
  }

  bool push(std::size_t, const Target& target) noexcept override { return push_to(filter_, target); }

  void set_speed(double fraction) noexcept override { (void)filter_.set_speed(fraction); }

  void tick(Report& report) noexcept override {
    const auto tick = tracker_->tick(filter_);
    report.status = tick.status;
    report.tasks[0].scale = tick.scale;
    report.tasks[0].position_error = tick.error.head<3>().norm();
    report.tasks[0].orientation_error = tick.error.tail<3>().norm();
  }

  void stop() noexcept override { tracker_->stop(); }

  [[nodiscard]] const fpbm::State<kDof>& state() const noexcept override { return tracker_->state(); }

  [[nodiscard]] const Joints& acceleration() const noexcept override { return tracker_->acceleration(); }

  void locate(Report& report) const noexcept override { report.tasks[0].at = tracker_->tip(); }

 private:
  [[nodiscard]] Scheme scheme_from(const Joints& rest) const {
    return fpbm::FPBM<kDof>(scheme_.alpha, scheme_.weights, gains_.k1, gains_.k2, null_space_of(scheme_, rest));
  }

  MotionScheme scheme_;
  fpbm::TaskGains<> gains_;
  fpbm::TrackerOptions<> options_;
  fpbm::Limits<Scheme::kLevel, kDof> limits_;
  Arm arm_;
  SharedBounds::View bounds_;
  fpbm::TargetFilter<fpbm::Pose> filter_;
  std::optional<fpbm::Tracker<Arm, fpbm::Pose, Scheme, SharedBounds::View>> tracker_;
};

}  // namespace

std::unique_ptr<Motion> make_tip_motion(const MotionSettings& settings) {
  return std::make_unique<TipMotion>(settings);
}

}  // namespace fpbm_controllers
