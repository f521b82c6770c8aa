// Custom kinematics in a control loop: tip, J and Jd are hand-written, and FPBM computes the joint accelerations.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>

using Plane = fpbm::Position<2>;

/// A prismatic joint along x [m] with two links of 0.5 m and 0.4 m. Any library can fill `out`. For an arm of N joints
/// in space, Kinematics<Position<3>, N>, the calls of Pinocchio are
///   computeJointJacobiansTimeVariation(model, data, q, qd), updateFramePlacements(model, data);
///   getFrameJacobian(model, data, tip, LOCAL_WORLD_ALIGNED, J);
///   getFrameJacobianTimeVariation(model, data, tip, LOCAL_WORLD_ALIGNED, Jd);
///   out.tip = data.oMf[tip].translation(), out.J = J.topRows<3>(), out.Jd = Jd.topRows<3>();
/// Kinematics<Pose, N> needs out.tip = {data.oMf[tip].translation(), data.oMf[tip].rotation()} and all six rows.
void kinematics(const fpbm::State<3>& state, fpbm::Kinematics<Plane, 3>& out) {
  const double a = state.q(1);
  const double b = state.q(1) + state.q(2);
  const double ad = state.qd(1);
  const double bd = state.qd(1) + state.qd(2);
  const fpbm::Vector<2> first{0.5 * std::cos(a), 0.5 * std::sin(a)};
  const fpbm::Vector<2> second{0.4 * std::cos(b), 0.4 * std::sin(b)};
  out.tip = {state.q(0) + first(0) + second(0), first(1) + second(1)};
  out.J << 1.0, -first(1) - second(1), -second(1),  //
      0.0, first(0) + second(0), second(0);
  out.Jd << 0.0, -ad * first(0) - bd * second(0), -bd * second(0),  //
      0.0, -ad * first(1) - bd * second(1), -bd * second(1);
}

int main() {
  const fpbm::Vector<3> weights{2.0, 1.0, 1.0};
  const auto damping = fpbm::NullSpace<3>().with_damping(4.0);
  const auto scheme = fpbm::FPBM<3>(0.6, weights, 40.0, 400.0, damping);  // alpha, W, k1, k2, z
  const fpbm::Path path(fpbm::Circle(0.1), 1.0, fpbm::Quintic{});         // radius [m], duration [s]
  constexpr double kStep = 1e-3;                                          // [s]

  fpbm::State<3> state{{0.0, 0.6, 0.9}, {0.0, 0.0, 0.0}};
  fpbm::Kinematics<Plane, 3> here;
  kinematics(state, here);
  const fpbm::Vector<2> start = here.tip;

  double error = 0.0, max_error = 0.0;
  for (int step = 0; step <= 1000; ++step) {
    kinematics(state, here);
    fpbm::Reference<Plane> reference = path.sample(step * kStep);
    reference.x += start;
    error = (reference.x - here.tip).norm();
    max_error = std::max(max_error, error);

    fpbm::Vector<3> qdd;
    const fpbm::Status status = scheme.resolve(here, reference, state, qdd);
    if (status != fpbm::Status::kOk) {
      std::printf("stopped at %g s: %s. %s\n", step * kStep, message(status), advice(status));
      return 1;
    }
    state.q += kStep * state.qd + kStep * kStep / 2.0 * qdd;  // Motion until the next tick.
    state.qd += kStep * qdd;
  }
  std::printf("tip error [m]: %.1e at most, %.1e at the end\n", max_error, error);
}
