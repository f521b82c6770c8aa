#pragma once

#include <fpbm/core/types.hpp>
#include <fpbm/geometry/space.hpp>
#include <fpbm/limits/limits.hpp>
#include <fpbm/target/stream.hpp>
#include <vector>

namespace fpbm_controllers {

/// A message of joint positions. The unused joints of the points are at zero.
struct JointChunk {
  static constexpr int kPoints = 129;  ///< Largest number of points, with the start.
  using Point = fpbm::TimedPoint<fpbm::JointSpace<fpbm::kMaxDof>>;

  std::vector<Point> points;
  bool starts = false;  ///< Whether the first point is the reference at the arrival, which the loop sets.
  double stamp = 0.0;   ///< Time from which the times of the points are counted [s]; 0: time of arrival.
  bool single = false;  ///< Whether the chunk is one posture without a time.
};

/// Stream of postures with unused joints, at rest at the posture nearest to zero. A tracker executes a reference
/// exactly if accelerations and jerks are 5 % below the limits of the tracker (docs/streams.md).
template <int kPoints>
[[nodiscard]] fpbm::JointStream<fpbm::kMaxDof, double, kPoints> stream_within(
    const fpbm::JointLimits<Eigen::Dynamic>& limits, const fpbm::StreamOptions<>& options = {}) {
  constexpr double kReserve = 0.95;
  auto all = fpbm::JointLimits<fpbm::kMaxDof>::none(fpbm::kMaxDof);
  all.velocity.setOnes();
  all.acceleration.setOnes();
  for (int i = 0; i < static_cast<int>(limits.lower.size()); ++i) {
    auto joint = limits.joint(i);
    joint.acceleration *= kReserve;
    joint.jerk *= kReserve;
    all.set(i, joint);
  }
  const fpbm::Vector<fpbm::kMaxDof> start = all.lower.cwiseMax(0.0).cwiseMin(all.upper);
  return {start, all, options};
}

}  // namespace fpbm_controllers
