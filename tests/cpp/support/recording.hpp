#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "fpbm/fpbm.hpp"
#include "support/paper.hpp"

namespace fpbm::test {

/// A rollout with all samples.
template <int N, typename Scalar = double, typename Space = Position<2>>
struct Recording {
  std::vector<Sample<Space, N, Scalar>> samples;
  RolloutResult<N, Scalar> result;

  /// Largest tip error [m] at or after t.
  [[nodiscard]] Scalar max_error(Scalar from = Scalar(0)) const {
    Scalar largest(0);
    for (const auto& sample : samples) {
      if (sample.t >= from) largest = std::max(largest, sample.error.norm());
    }
    return largest;
  }
};

template <typename Arm, typename Path, typename Scheme>
[[nodiscard]] Recording<Arm::kDof, typename Arm::Scalar, typename Path::Space> recorded(
    const Arm& arm, const Path& path, const Scheme& scheme, const State<Arm::kDof, typename Arm::Scalar>& start,
    const TimeGrid<typename Arm::Scalar>& grid) {
  std::vector<Sample<typename Path::Space, Arm::kDof, typename Arm::Scalar>> samples;
  samples.reserve(static_cast<std::size_t>(grid.samples()));
  const auto result = rollout(arm, path, scheme, start, grid, [&](const auto& sample) { samples.push_back(sample); });
  return {std::move(samples), result};
}

/// A planar scheme as AnyScheme, for rollouts that are compiled once.
template <typename Scheme>
[[nodiscard]] AnyScheme<Scheme::kLevel, Position<2>> erased(const Scheme& scheme) {
  return AnyScheme<Scheme::kLevel, Position<2>>(scheme);
}
[[nodiscard]] AnyScheme<Level::kAcceleration, Position<2>> erased(const AccelerationScheme<Eigen::Dynamic>& scheme);
[[nodiscard]] AnyScheme<Level::kAcceleration, Position<2>> erased(
    const AccelerationScheme<Eigen::Dynamic, double, UnitWeights>& scheme);
[[nodiscard]] AnyScheme<Level::kVelocity, Position<2>> erased(const VelocityScheme<Eigen::Dynamic>& scheme);
[[nodiscard]] AnyScheme<Level::kVelocity, Position<2>> erased(
    const VelocityScheme<Eigen::Dynamic, double, UnitWeights>& scheme);

// The arm of the paper with the schemes of many tests: compiled once, in recording.cpp.
extern template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&, const AccelerationScheme<4>&,
                                      const State<4>&, const TimeGrid<>&);
extern template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&,
                                      const AccelerationScheme<4, double, UnitWeights>&, const State<4>&,
                                      const TimeGrid<>&);
extern template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&, const VelocityScheme<4>&,
                                      const State<4>&, const TimeGrid<>&);
extern template Recording<4> recorded(const PlanarArm<4>&, const AnyPath<Position<2>>&,
                                      const VelocityScheme<4, double, UnitWeights>&, const State<4>&,
                                      const TimeGrid<>&);

// Planar arms with schemes of run-time type.
extern template Recording<Eigen::Dynamic> recorded(const AnyArm<Position<2>>&, const AnyPath<Position<2>>&,
                                                   const AnyScheme<Level::kAcceleration, Position<2>>&,
                                                   const State<Eigen::Dynamic>&, const TimeGrid<>&);
extern template Recording<Eigen::Dynamic> recorded(const AnyArm<Position<2>>&, const AnyPath<Position<2>>&,
                                                   const AnyScheme<Level::kVelocity, Position<2>>&,
                                                   const State<Eigen::Dynamic>&, const TimeGrid<>&);

// Poses of the Panda.
extern template Recording<7, double, Pose> recorded(const SerialArm<7>&, const AnyPath<Pose>&,
                                                    const AccelerationScheme<7>&, const State<7>&, const TimeGrid<>&);

}  // namespace fpbm::test
