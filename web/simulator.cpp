// C functions for the arms of the page, for WebAssembly. Settings and view are arrays of numbers that the caller writes
// and reads. web/simulator.js has the same order.

#include <cmath>
#include <fpbm/bound/preset_capsules.hpp>
#include <fpbm/model/planar_arm.hpp>
#include <fpbm/model/presets.hpp>
#include <fpbm/model/serial_arm.hpp>
#include <fpbm/path/placed.hpp>
#include <memory>
#include <vector>

#include "session.hpp"

namespace {

using Circle = fpbm::Path<fpbm::Circle<>>;
using SmoothCircle = fpbm::Path<fpbm::Circle<>, fpbm::Quintic>;
using Upright = fpbm::InPlane<SmoothCircle>;

page::Settings settings;
page::View view;
std::unique_ptr<page::Simulator> simulator;

/// The paper's arm and circle: four links of 1 m.
std::unique_ptr<page::Simulator> planar() {
  constexpr double kPi = fpbm::kTwoPi / 2.0;
  fpbm::Chain<> chain = fpbm::modified_dh<double>({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
  chain.tip.p(0) = 1.0;
  std::vector<fpbm::LinkCapsule<>> capsules;
  for (int i = 1; i <= 4; ++i) capsules.push_back({i, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.15 - 0.015 * i}, ""});
  auto bounds = fpbm::JointLimits<4>::none(4);
  for (Eigen::Index i = 0; i < 4; ++i) bounds.set(i, {-2.8, 2.8, 2.5, 20.0, 1000.0});
  return std::make_unique<page::Session<fpbm::PlanarArm<4>, fpbm::Position<2>, Circle>>(
      chain, capsules, fpbm::PlanarArm<4>({1.0, 1.0, 1.0, 1.0}), bounds,
      fpbm::Vector<4>(kPi / 12, kPi / 12, kPi / 15, kPi / 15), Circle(fpbm::Circle(0.45), 10.0),
      fpbm::TargetBounds<>{4.0, 20.0, 400.0}, settings);
}

template <typename Space, typename Path>
std::unique_ptr<page::Simulator> panda(const Path& path) {
  const fpbm::Chain<> chain = fpbm::presets::panda();
  const fpbm::SerialArm<7> arm(chain);
  fpbm::Vector<7> q0;
  q0 << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.785;
  return std::make_unique<page::Session<fpbm::SerialArm<7>, Space, Path>>(
      chain, fpbm::presets::capsules::panda(), arm, arm.limits(), q0, path,
      fpbm::TargetBounds<>{1.0, 5.0, 100.0, 2.0, 10.0, 200.0}, settings);
}

}  // namespace

extern "C" {

double* settings_address() {
  return &settings.scheme;
}
const double* view_address() {
  return &view.dof;
}

/// Starts with an arm: 0 the planar arm, 1 a Panda with a pose task, 2 a Panda with a position task.
void begin(int arm) {
  const Upright circle(SmoothCircle(fpbm::Circle(0.15), 4.0), {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
  if (!settings.good()) settings = {};
  simulator = arm == 0   ? planar()
              : arm == 1 ? panda<fpbm::Pose>(fpbm::WithRotation(circle))
                         : panda<fpbm::Position<3>>(circle);
  view = {};
  simulator->show(view);
}

/// Applies the settings. Returns 1, or 0 if the arm had to restart, or -1 if a setting is out of range.
int change() {
  if (!simulator || !settings.good()) return -1;
  const bool goes_on = simulator->change(settings);
  simulator->show(view);
  return goes_on ? 1 : 0;
}

void restart() {
  simulator->restart();
  simulator->show(view);
}

void follow_path() {
  simulator->follow_path();
  simulator->show(view);
}

void push(double x, double y, double z) {
  simulator->push({x, y, z});
}

void ticks(int count) {
  simulator->ticks(count);
  simulator->show(view);
}
}
