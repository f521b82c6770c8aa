#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "fpbm/model/chain.hpp"
#include "fpbm/model/detail/preset_parts.hpp"
#include "fpbm/model/dh.hpp"
#include "fpbm/model/joint.hpp"

/// Presets of the arms of Franka Robotics; see presets.hpp.
namespace fpbm::presets {

/// Franka Emika Panda, 7 joints, to its flange (link 8 in ROS).
///
/// Source: Franka Control Interface documentation of August 2025, "Robot and interface specifications": "Limits for
/// Panda", and "Denavit–Hartenberg parameters" in Craig's convention, which also hold for the Franka Research 3.
/// Inertias: C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca, "Dynamic Identification of the Franka
/// Emika Panda Robot With Retrieval of Feasible Parameters Using Penalty-Based Optimization", IEEE RA-L 4(4), 2019, as
/// in franka_ros (Apache-2.0), franka_description/robots/common/inertial.yaml. The hand is not included.
[[nodiscard]] inline Chain<> panda() {
  using arms::kRight;
  Chain<> chain = modified_dh<double>({
      // a [m], alpha [rad], d [m]
      {0.0, 0.0, 0.333},
      {0.0, -kRight, 0.0},
      {0.0, kRight, 0.316},
      {0.0825, kRight, 0.0},
      {-0.0825, -kRight, 0.384},
      {0.0, kRight, 0.0},
      {0.088, kRight, 0.0},
  });
  chain.tip.p(2) = 0.107;
  const std::vector<JointBounds<>> bounds = {
      // [rad], [rad], [rad/s], [rad/s²], [rad/s³]
      {-2.8973, 2.8973, 2.1750, 15.0, 7500.0},  {-1.7628, 1.7628, 2.1750, 7.5, 3750.0},
      {-2.8973, 2.8973, 2.1750, 10.0, 5000.0},  {-3.0718, -0.0698, 2.1750, 12.5, 6250.0},
      {-2.8973, 2.8973, 2.6100, 15.0, 7500.0},  {-0.0175, 3.7525, 2.6100, 20.0, 10000.0},
      {-2.8973, 2.8973, 2.6100, 20.0, 10000.0},
  };
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {4.970684, {0.003875, 0.002081, -0.04762}, 0.70337, -0.000139, 0.006772, 0.70661, 0.019169, 0.009117},
      {0.646926, {-0.003141, -0.02872, 0.003495}, 0.007962, -0.003925, 0.010254, 0.02811, 0.000704, 0.025995},
      {3.228604, {0.027518, 0.039252, -0.066502}, 0.037242, -0.004761, -0.011396, 0.036155, -0.012805, 0.01083},
      {3.587895, {-0.05317, 0.104419, 0.027454}, 0.025853, 0.007796, -0.001332, 0.019552, 0.008641, 0.028323},
      {1.225946, {-0.011953, 0.041065, -0.038437}, 0.035549, -0.002117, -0.004037, 0.029474, 0.000229, 0.008627},
      {1.666555, {0.060149, -0.014117, -0.010517}, 0.001964, 0.000109, -0.001158, 0.004354, 0.000341, 0.005433},
      {0.735522, {0.010517, -0.004252, 0.061597}, 0.012516, -0.000428, -0.001196, 0.010027, -0.000741, 0.004815},
  };
  return arms::powered(arms::driven(chain, "panda_joint", bounds), links, {87, 87, 87, 87, 12, 12, 12});
}

/// Franka Research 3, 7 joints, to its flange. The links are the links of the Panda.
///
/// Sources: bounds on position, on velocity, and on velocity near the ends from the URDF of the robot in libfranka
/// 0.21, test/fr3.urdf; accelerations and jerks from the Franka Control Interface documentation of August 2025, "Limits
/// for Franka Research 3". Inertias and efforts: franka_description of Franka Robotics (Apache-2.0), robots/fr3,
/// inertials.yaml and joint_limits.yaml, rounded to 6 digits. The hand is not included.
[[nodiscard]] inline Chain<> fr3() {
  constexpr double kAcceleration = 10.0;
  constexpr double kJerk = 5000.0;
  const std::vector<JointBounds<>> bounds = {
      // [rad], [rad], [rad/s], [rad/s²], [rad/s³], offset [rad/s], deceleration [rad/s²]
      {-2.7501, 2.7501, 2.62, kAcceleration, kJerk, 0.30, 6.0},
      {-1.7918, 1.7918, 2.62, kAcceleration, kJerk, 0.20, 2.585},
      {-2.9065, 2.9065, 2.62, kAcceleration, kJerk, 0.20, 3.5},
      {-3.0481, -0.1458, 2.62, kAcceleration, kJerk, 0.30, 4.0},
      {-2.8101, 2.8101, 5.26, kAcceleration, kJerk, 0.35, 17.0},
      {0.54092, 4.5205, 4.18, kAcceleration, kJerk, 0.35, 5.5},
      {-3.0196, 3.0196, 5.26, kAcceleration, kJerk, 0.35, 17.0},
  };
  const std::vector<arms::Body> links = {
      // [kg], [m], xx, xy, xz, yy, yz, zz [kg m²]
      {2.927465, {0, -0.018125, -0.038604}, 0.0239273, 0.0000133, -0.000114, 0.0224822, -0.001995, 0.0063501},
      {2.935537, {0.003183, -0.074322, 0.008815}, 0.0419389, 0.0002026, 0.0040778, 0.0251451, -0.0042252, 0.0617021},
      {2.244901, {0.040702, -0.00482, -0.028973}, 0.0241014, 0.0024047, -0.0028563, 0.0197405, -0.0021042, 0.0190445},
      {2.615596, {-0.04591, 0.063049, -0.008519}, 0.03453, 0.0132255, 0.0101514, 0.0288816, -0.0009763, 0.0412547},
      {2.327121, {-0.001604, 0.029254, -0.097297}, 0.0516103, -0.0057152, -0.0035673, 0.0478773, 0.010674, 0.0164236},
      {1.817038, {0.059713, -0.041029, -0.010169}, 0.0054123, 0.0061935, 0.0014219, 0.0140583, -0.0013141, 0.0160808},
      {0.627143,
       {0.004523, 0.008626, -0.016163},
       0.000210924,
       -2.4333e-5,
       4.5645e-5,
       0.000177186,
       8.7441e-5,
       5.9932e-5},
  };
  return arms::powered(arms::driven(panda(), "fr3_joint", bounds), links, {87, 87, 87, 87, 12, 12, 12});
}

}  // namespace fpbm::presets
