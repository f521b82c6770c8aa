#pragma once

#include <fpbm/bound/clearance.hpp>
#include <optional>
#include <string>

namespace fpbm_controllers {

using Clearance = fpbm::Clearance<Eigen::Dynamic>;

/// The nearest pair of shapes of a clearance.
struct NearestPair {
  std::string names;
  double distance;  ///< [m]
  double margin;    ///< [m]

  [[nodiscard]] bool is_too_close() const noexcept { return distance < margin; }
  [[nodiscard]] std::string too_close() const {
    return names + " are " + std::to_string(distance) +
           " m apart, closer than clearance.margin = " + std::to_string(margin) + ": ";
  }
};

/// The nearest pair in the posture q. None if there are no pairs. Allocates.
[[nodiscard]] inline std::optional<NearestPair> nearest_pair(const Clearance& clearance,
                                                             const fpbm::Vector<Eigen::Dynamic>& q) {
  const auto [pair, distance] = clearance.nearest_pair(q);
  if (pair == clearance.pairs().size()) return std::nullopt;
  const auto [first, second] = clearance.names(clearance.pairs()[pair]);
  return NearestPair{first + " and " + second, distance, clearance.margin()};
}

}  // namespace fpbm_controllers
