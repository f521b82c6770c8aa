// Postures for targets: random poses, all branches of a UR5e, and a Panda at a table.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>
#include <random>
#include <vector>

using Joints = fpbm::Vector<7>;

/// Random poses that a Panda reaches, from random postures.
void random_poses() {
  const fpbm::SerialArm<7> arm(fpbm::presets::panda());
  fpbm::InverseOptions<> options;
  options.starts = 256;
  fpbm::InverseKinematics inverse(arm, fpbm::Pose{}, options);
  std::mt19937 engine(0);
  const auto random = [&] {
    Joints q;
    for (int i = 0; i < 7; ++i) {
      q(i) = std::uniform_real_distribution<>(arm.limits().lower(i), arm.limits().upper(i))(engine);
    }
    return q;
  };
  int solved = 0;
  double error = 0.0;
  for (int i = 0; i < 1000; ++i) {
    fpbm::Kinematics<fpbm::Pose, 7> kinematics;
    arm.kinematics(random(), kinematics);
    const auto posture = inverse.solve(kinematics.tip, random());
    solved += posture.solved() ? 1 : 0;
    error = std::max(error, posture.error);
  }
  std::printf("%d of 1000 poses reached, largest error %.0e m or rad\n", solved, error);
}

/// search() calls a function for each solution. Solutions that differ by whole turns are the same branch.
void branches() {
  const fpbm::SerialArm<6> arm(fpbm::presets::ur5e());
  fpbm::InverseOptions<> options;
  options.starts = 256;
  fpbm::InverseKinematics inverse(arm, fpbm::Pose{}, options);
  const fpbm::Vector<6> q{0.3, -1.1, 1.4, -0.9, 1.2, 0.4};
  fpbm::Kinematics<fpbm::Pose, 6> kinematics;
  arm.kinematics(q, kinematics);
  std::vector<fpbm::Vector<6>> known;
  inverse.search(kinematics.tip, q, [&](const auto& found) {
    const auto is_same = [&](const fpbm::Vector<6>& other) {
      for (int i = 0; i < 6; ++i) {
        if (std::abs(std::remainder(other(i) - found.q(i), fpbm::kTwoPi)) > 1e-3) return false;
      }
      return true;
    };
    if (std::none_of(known.begin(), known.end(), is_same)) known.push_back(found.q);
    return false;  // Continue.
  });
  std::printf("%zu branches of a UR5e\n", known.size());
}

/// A stack of tasks, within bounds.
void at_a_table() {
  const auto chain = fpbm::presets::panda();
  const fpbm::Robot<7> robot(chain);
  const fpbm::Stack stack(fpbm::PoseTask<>{fpbm::LinkFrame<>(fpbm::Robot<7>::kTip), fpbm::TaskGains<>(1.0)});
  const std::vector<fpbm::Obstacle<>> table{{"table", fpbm::HalfSpace<>{{0.0, 0.0, 1.0}, 0.0}}};
  fpbm::Clearance<7> clearance(chain, fpbm::presets::capsules::panda(), table, 0.01,
                               fpbm::presets::never_collide::panda());
  fpbm::InverseKinematics inverse(robot, stack, {}, robot.limits(), fpbm::Bounds(clearance));
  auto target = inverse.tip(Joints::Zero());
  auto& tip = std::get<0>(target);
  tip.R << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;  // The flange points down.
  tip.p << 0.5, 0.2, 0.15;
  const Joints start = (robot.limits().lower + robot.limits().upper) / 2.0;
  const auto above = inverse.solve(target, start);
  auto placed = clearance.placement();
  std::printf("above the table: %s, least distance %.3f m\n", above.solved() ? "solved" : "not found",
              clearance.nearest_pair(above.q, placed).second);
  tip.p(2) = -0.1;
  const auto below = inverse.solve(target, start);
  std::printf("below the table: %s, %.2f m or rad away, after %d starts\n", below.solved() ? "solved" : "not found",
              below.error, below.starts);
}

int main() {
  random_poses();
  branches();
  at_a_table();
}
