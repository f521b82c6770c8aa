#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fpbm/inverse/inverse_kinematics.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <fpbm_moveit/model_chain.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>
#if __has_include(<moveit/kinematics_base/kinematics_base.hpp>)
#include <moveit/kinematics_base/kinematics_base.hpp>
#else
#include <moveit/kinematics_base/kinematics_base.h>
#endif

namespace fpbm_moveit {

using PoseMessage = geometry_msgs::msg::Pose;

/// None if a number is not finite, or the quaternion's length differs from 1 by more than 0.01.
[[nodiscard]] inline std::optional<fpbm::Transform<>> transform_of(const PoseMessage& message) {
  const auto& p = message.position;
  const auto& o = message.orientation;
  const fpbm::Vector<4> q(o.w, o.x, o.y, o.z);
  fpbm::Transform<> pose;
  pose.p = {p.x, p.y, p.z};
  if (!pose.p.allFinite() || !(std::abs(q.norm() - 1.0) < 0.01)) return std::nullopt;
  pose.R = fpbm::rotation(fpbm::Vector<4>(q / q.norm()));
  return pose;
}

[[nodiscard]] inline PoseMessage message_of(const fpbm::Transform<>& pose) {
  const fpbm::Vector<4> q = fpbm::quaternion(pose.R);
  PoseMessage message;
  message.position.x = pose.p(0);
  message.position.y = pose.p(1);
  message.position.z = pose.p(2);
  message.orientation.w = q(0);
  message.orientation.x = q(1);
  message.orientation.y = q(2);
  message.orientation.z = q(3);
  return message;
}

/// Inverse kinematics of fpbm for the groups of MoveIt that are chains.
///
/// An instance may be used by several threads: each call has its own search.
class KinematicsPlugin : public kinematics::KinematicsBase {
 public:
  using ErrorCode = moveit_msgs::msg::MoveItErrorCodes;
  using Options = kinematics::KinematicsQueryOptions;
  using Numbers = std::vector<double>;
  using kinematics::KinematicsBase::getPositionIK;
  using kinematics::KinematicsBase::searchPositionIK;

  bool initialize(const rclcpp::Node::SharedPtr& node, const moveit::core::RobotModel& model, const std::string& group,
                  const std::string& base, const std::vector<std::string>& tips, double discretization) override {
    node_ = node;
    storeValues(model, group, base, tips, discretization);
    try {
      if (tips.size() != 1) throw std::invalid_argument("must have one tip: give a group that is a chain");
      const fpbm::Chain<> chain = chain_of(model, base_frame_, tip_frames_[0]);
      joints_.clear();
      for (const auto& joint : chain.joints) joints_.push_back(joint.name);
      if (const auto* of = model.getJointModelGroup(group); of == nullptr || of->getVariableNames() != joints_) {
        throw std::invalid_argument("must have the joints from '" + base_frame_ + "' to '" + tip_frames_[0] +
                                    "': give the group these joints");
      }
      switch (joints_.size()) {
        case 6: solver_.emplace<Solver<6>>(chain); break;
        case 7: solver_.emplace<Solver<7>>(chain); break;
        default: solver_.emplace<Solver<Eigen::Dynamic>>(chain); break;
      }
      return true;
    } catch (const std::exception& error) {
      RCLCPP_ERROR(rclcpp::get_logger("fpbm_moveit"), "group '%s': %s", group.c_str(), error.what());
      solver_ = std::monostate();
      return false;
    }
  }

  bool getPositionIK(const PoseMessage& pose, const Numbers& seed, Numbers& solution, ErrorCode& error,
                     const Options& options) const override {
    return solve({pose, seed, 1, 0.0, {}, nullptr, options}, solution, error);  // Only the seed is a start posture.
  }
  bool searchPositionIK(const PoseMessage& pose, const Numbers& seed, double timeout, Numbers& solution,
                        ErrorCode& error, const Options& options) const override {
    return solve({pose, seed, kStarts, timeout, {}, nullptr, options}, solution, error);
  }
  bool searchPositionIK(const PoseMessage& pose, const Numbers& seed, double timeout, const Numbers& consistency,
                        Numbers& solution, ErrorCode& error, const Options& options) const override {
    return solve({pose, seed, kStarts, timeout, consistency, nullptr, options}, solution, error);
  }
  bool searchPositionIK(const PoseMessage& pose, const Numbers& seed, double timeout, Numbers& solution,
                        const IKCallbackFn& callback, ErrorCode& error, const Options& options) const override {
    return solve({pose, seed, kStarts, timeout, {}, callback, options}, solution, error);
  }
  bool searchPositionIK(const PoseMessage& pose, const Numbers& seed, double timeout, const Numbers& consistency,
                        Numbers& solution, const IKCallbackFn& callback, ErrorCode& error,
                        const Options& options) const override {
    return solve({pose, seed, kStarts, timeout, consistency, callback, options}, solution, error);
  }

  /// Poses of the tip in the base frame. Returns false for other links.
  bool getPositionFK(const std::vector<std::string>& links, const Numbers& q,
                     std::vector<PoseMessage>& poses) const override {
    const bool known = std::all_of(links.begin(), links.end(), [&](const auto& link) { return link == getTipFrame(); });
    poses.clear();
    return known && with_solver(q, [&](const auto& solver, const auto& posture) {
             poses.assign(links.size(), message_of(solver.inverse.tip(posture)));
             return true;
           });
  }

  const std::vector<std::string>& getJointNames() const override { return joints_; }
  const std::vector<std::string>& getLinkNames() const override { return tip_frames_; }

 private:
  static constexpr double kTolerance = 1e-6;  ///< [m, rad]
  static constexpr int kStarts = 256;         ///< Every reachable pose in docs/inverse.md needs fewer start postures.

  template <int N>
  struct Solver {
    using Posture = fpbm::Vector<N>;
    using Inverse = fpbm::InverseKinematics<fpbm::SerialArm<N>, fpbm::Pose>;

    explicit Solver(const fpbm::Chain<>& chain) : arm(chain), inverse(arm, fpbm::Pose{}, {kTolerance, kStarts, 0}) {}

    fpbm::SerialArm<N> arm;
    Inverse inverse;
  };
  struct Query {
    const PoseMessage& pose;
    const Numbers& seed;
    int starts;
    double timeout;
    const Numbers& consistency;
    const IKCallbackFn& callback;
    const Options& options;
  };

  /// Calls f(solver, posture). Returns false if the number of joints is wrong, or the plugin is not initialised.
  template <typename F>
  bool with_solver(const Numbers& q, const F& f) const {
    return std::visit(
        [&](const auto& solver) {
          using Solver_ = std::decay_t<decltype(solver)>;
          if constexpr (std::is_same_v<Solver_, std::monostate>) {
            return false;
          } else {
            if (q.size() != joints_.size()) return false;
            return f(solver, typename Solver_::Posture(Eigen::Map<const Eigen::VectorXd>(q.data(), solver.arm.dof())));
          }
        },
        solver_);
  }

  /// All functions that compute postures. If the callback rejects all postures of a search, the next search has other
  /// start postures, until the timeout. A search without a posture is the last search.
  bool solve(const Query& query, Numbers& solution, ErrorCode& error) const {
    error.val = ErrorCode::NO_IK_SOLUTION;
    const auto target = transform_of(query.pose);
    if (!target) return false;
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(query.timeout);
    const auto accepts = [&](const auto& q) {
      solution.assign(q.begin(), q.end());
      error.val = ErrorCode::SUCCESS;
      if (query.callback) query.callback(query.pose, solution, error);
      return error.val == ErrorCode::SUCCESS;
    };
    return with_solver(query.seed, [&](const auto& solver, const auto& seed) {
      auto limits = solver.arm.limits();
      if (!narrow(limits, seed, query.consistency)) return false;
      for (std::uint32_t round = 0;; ++round) {
        bool found = false;
        bool accepted = false;
        using Inverse = typename std::decay_t<decltype(solver)>::Inverse;
        const bool usual = round == 0 && query.starts == kStarts && query.consistency.empty();
        Inverse inverse =
            usual ? solver.inverse : Inverse(solver.arm, fpbm::Pose{}, {kTolerance, query.starts, round}, limits);
        const auto last = inverse.search(*target, seed, [&](const auto& posture) {
          found = true;
          accepted = accepts(posture.q);
          return accepted || Clock::now() >= end;
        });
        if (accepted) return true;
        const bool approximate = query.options.return_approximate_solution && last.q.allFinite();
        if (!found && approximate && accepts(last.q)) return true;
        if (found && Clock::now() < end) continue;
        error.val = found ? ErrorCode::TIMED_OUT : ErrorCode::NO_IK_SOLUTION;
        return false;
      }
    });
  }
  /// Narrows the ranges to the distances `consistency` from the seed. Returns false if no posture remains.
  template <typename Limits, typename Posture>
  static bool narrow(Limits& limits, const Posture& seed, const Numbers& consistency) {
    if (consistency.empty()) return true;
    if (consistency.size() != static_cast<std::size_t>(seed.size())) return false;
    const Eigen::Map<const Eigen::VectorXd> distance(consistency.data(), seed.size());
    limits.lower = limits.lower.cwiseMax(seed - distance);
    limits.upper = limits.upper.cwiseMin(seed + distance);
    return (limits.lower.array() <= limits.upper.array()).all();
  }

  std::vector<std::string> joints_;
  std::variant<std::monostate, Solver<6>, Solver<7>, Solver<Eigen::Dynamic>> solver_;
};

}  // namespace fpbm_moveit
