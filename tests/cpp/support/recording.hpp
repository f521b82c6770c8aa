#pragma once

#include <algorithm>
#include <vector>

#include "fpbm/fpbm.hpp"

namespace fpbm::test {

/// A rollout with every sample kept.
template <int N, typename Scalar = double>
struct Recording {
  std::vector<Sample<Position<2>, N, Scalar>> samples;
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
[[nodiscard]] Recording<Arm::kDof, typename Arm::Scalar> recorded(const Arm& arm, const Path& path,
                                                                  const Scheme& scheme,
                                                                  const State<Arm::kDof, typename Arm::Scalar>& start,
                                                                  const TimeGrid<typename Arm::Scalar>& grid) {
  std::vector<Sample<typename Path::Space, Arm::kDof, typename Arm::Scalar>> samples;
  samples.reserve(static_cast<std::size_t>(grid.samples()));
  const auto result = rollout(arm, path, scheme, start, grid, [&](const auto& sample) { samples.push_back(sample); });
  return {std::move(samples), result};
}

}  // namespace fpbm::test
