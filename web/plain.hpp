#pragma once

#include <algorithm>
#include <fpbm/core/types.hpp>

/// Data between the page and its arms.
namespace page {

enum class Scheme { kMvn, kWmvn, kMan, kWmvnAcceleration, kFpbm };

/// Settings of the page, as numbers.
struct Settings {
  double scheme = static_cast<double>(Scheme::kFpbm);
  double alpha = 0.6;
  double feedback = 5.0;  ///< Decay rate of a tip error [1/s].
  double damping = 0.0;   ///< Null-space damping [1/s].
  double limited = 1.0;   ///< Whether joint limits are kept.
  double weights[7] = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0};

  [[nodiscard]] bool good() const noexcept {
    const auto within = [](double value, double low, double high) { return low <= value && value <= high; };
    return within(scheme, 0.0, 4.0) && within(alpha, 0.0, 1.0) && within(feedback, 0.0, 50.0) &&
           within(damping, 0.0, 50.0) &&
           std::all_of(weights, weights + 7, [&](double weight) { return within(weight, 0.01, 100.0); });
  }
};

/// Data that the page draws, as numbers. Velocities are from the last tick. Scale and status are the worst of the ticks
/// of the last call.
struct View {
  double dof = 0.0;
  double time = 0.0;
  double status = 0.0;
  double scale = 1.0;
  double error = 0.0;      ///< Position error of the tip [m].
  double following = 0.0;  ///< Whether the arm follows its path.
  double q[7] = {};
  double qd[7] = {};
  double tip[3] = {};
  double reference[3] = {};    ///< Current reference of the tip.
  double frames[8][12] = {};   ///< Origin, then axes x, y, z, of the base and of each link.
  double capsules[8][8] = {};  ///< Link, two points in its frame, radius; 0 without a capsule.
};

/// An arm of any type that follows its path or a target.
struct Simulator {
  Simulator() = default;
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;
  virtual ~Simulator() = default;
  virtual bool change(const Settings& settings) = 0;
  virtual void restart() = 0;
  virtual void follow_path() = 0;
  virtual void push(const fpbm::Vector<3>& target) noexcept = 0;
  virtual void ticks(int count) noexcept = 0;
  virtual void show(View& view) noexcept = 0;
};

}  // namespace page
