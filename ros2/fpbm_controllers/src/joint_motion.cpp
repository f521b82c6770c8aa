#include <fpbm/any/any_stack.hpp>
#include <fpbm/model/robot.hpp>
#include <fpbm/realtime/stack_tracker.hpp>
#include <fpbm/scheme/schemes.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <vector>

#include "fpbm_controllers/kept_stream.hpp"
#include "fpbm_controllers/motion.hpp"

namespace fpbm_controllers {

namespace {

constexpr int kDof = Eigen::Dynamic;  // One instantiation serves robots of any number of joints.
using Robot = fpbm::Robot<kDof>;
using Level = fpbm::TaskLevel<fpbm::AnyPostureTask>;
using Stack = fpbm::Stack<Level>;
using Space = Stack::Space;
using Tasks = fpbm::RobotTasks<Robot, Stack>;
using Scheme = fpbm::ByLevels<fpbm::AccelerationScheme<kDof>, Stack>;
using Tracker = fpbm::Tracker<Tasks, Space, Scheme, SharedBounds::View>;
using Padded = fpbm::Vector<fpbm::kMaxDof>;

[[nodiscard]] Padded padded(const MotionScheme::Joints& q) {
  Padded all = Padded::Zero();
  all.head(q.size()) = q;
  return all;
}

[[nodiscard]] Stack stack_of(const MotionSettings& settings) {
  std::vector<int> joints(static_cast<std::size_t>(settings.limits.bounds().lower.size()));
  std::iota(joints.begin(), joints.end(), 0);
  return Stack(Level(fpbm::AnyPostureTask(joints, settings.tasks.at(0).gains)));
}

class JointMotion final : public Motion {
 public:
  explicit JointMotion(const MotionSettings& settings)
      : scheme_(settings.scheme),
        options_(settings.options),
        limits_(settings.limits),
        robot_(settings.tree),
        tip_(settings.tasks.at(0).frame),
        tasks_(robot_, stack_of(settings)),
        bounds_(settings.bounds),
        stream_(limits_.bounds(), settings.filter, settings.keep_path) {
    tip_.bind(robot_);
    const fpbm::TickOfGains<> tick{options_.dt, 0.0};
    const Scheme scheme = scheme_from(Joints::Zero(robot_.dof()));
    try {
      fpbm::require_stack_gains(scheme.scheme, stack_of(settings), tick);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(settings.tasks[0].gains_of + error.what());
    }
    fpbm::require_stable(scheme, tick);
  }

  void begin(const Joints& q, const Joints& rest) override {
    const fpbm::State<kDof> start{q, Joints::Zero(q.size())};
    tracker_.emplace(tasks_, Space{}, scheme_from(rest), start, options_, limits_, start.qd, bounds_);
    stream_.reset(padded(q));
  }

  bool push_chunk(JointChunk& chunk) noexcept override { return stream_.push(chunk); }

  void set_speed(double fraction) noexcept override { stream_.set_speed(fraction); }

  void tick(Report& report) noexcept override {
    const auto tick = tracker_->advance(fpbm::references_of(Space{}, options_.dt, stream_));
    const double error = tick.error.cwiseAbs().maxCoeff();
    stream_.advance(error);
    report.status = tick.status;
    report.tasks[0].scale = tick.scale;
    report.tasks[0].orientation_error = error;
    report.age = stream_.age();
  }

  void stop() noexcept override { tracker_->stop(); }

  [[nodiscard]] const fpbm::State<kDof>& state() const noexcept override { return tracker_->state(); }

  [[nodiscard]] const Joints& acceleration() const noexcept override { return tracker_->acceleration(); }

  void locate(Report& report) const noexcept override {
    Robot::State state;
    robot_.update(tracker_->state().q, state);
    report.tasks[0].at = tip_.at(robot_, state);
  }

 private:
  [[nodiscard]] Scheme scheme_from(const Joints& rest) const {
    return Scheme(fpbm::Balanced<kDof>(scheme_.alpha, scheme_.weights, null_space_of(scheme_, rest)));
  }

  MotionScheme scheme_;
  fpbm::TrackerOptions<> options_;
  fpbm::Limits<fpbm::Level::kAcceleration, kDof> limits_;
  Robot robot_;
  fpbm::LinkFrame<> tip_;
  Tasks tasks_;
  SharedBounds::View bounds_;
  KeptStream stream_;
  std::optional<Tracker> tracker_;
};

}  // namespace

std::unique_ptr<Motion> make_joint_motion(const MotionSettings& settings) {
  return std::make_unique<JointMotion>(settings);
}

}  // namespace fpbm_controllers
