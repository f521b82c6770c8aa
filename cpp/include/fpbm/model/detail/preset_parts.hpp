#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fpbm/geometry/rotation.hpp"
#include "fpbm/model/chain.hpp"
#include "fpbm/model/joint.hpp"

/// Parts of the presets of arms and robots.
namespace fpbm::presets::arms {

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr double kRight = 90.0 * kDegree;
constexpr double kHalfTurn = 180.0 * kDegree;

/// Symmetric bounds of a joint.
struct BothWays {
  double position;      ///< [deg]
  double velocity;      ///< [deg/s]
  double acceleration;  ///< [rad/s²]

  operator JointBounds<>() const { return {-position * kDegree, position * kDegree, velocity * kDegree, acceleration}; }
};

/// The chain with the given bounds, and with joints named name1, name2, …
template <typename Bounds>
[[nodiscard]] Chain<> driven(Chain<> chain, const std::string& name, const std::vector<Bounds>& bounds) {
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    chain.joints[i].name = name + std::to_string(i + 1);
    chain.joints[i].bounds = bounds[i];
  }
  return chain;
}

/// Inertia of a link: mass [kg], centre of mass [m], and rotational inertia about the centre [kg m²].
struct Body {
  double mass;
  Vector<3> centre;
  double xx, xy, xz, yy, yz, zz;

  /// In a frame in which `place` is the frame of the numbers.
  [[nodiscard]] LinkInertia<> in(const Transform<>& place) const {
    const Matrix<3, 3> inertia{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
    return {mass, (place * Transform<>{centre, {}}).p, times(times(place.R, inertia), transposed(place.R))};
  }
};

/// The chain with the links, given in the frames of the links, and with bounds on the efforts [Nm].
[[nodiscard]] inline Chain<> powered(Chain<> chain, const std::vector<Body>& links,
                                     const std::vector<double>& efforts) {
  for (std::size_t i = 0; i < links.size(); ++i) {
    chain.joints[i].moved = links[i].in({});
    chain.joints[i].bounds.effort = efforts[i];
  }
  return chain;
}

/// Frame of a joint as in a URDF file: origin [m]; roll, pitch and yaw about fixed axes [rad].
[[nodiscard]] inline Transform<> placed(const Vector<3>& origin, const Vector<3>& turn) {
  return {origin, rotation(Vector<3>(0.0, 0.0, turn(2))) * rotation(Vector<3>(0.0, turn(1), 0.0)) *
                      rotation(Vector<3>(turn(0), 0.0, 0.0))};
}

}  // namespace fpbm::presets::arms
