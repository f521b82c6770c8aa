#include <cmath>
#include <fpbm/model/presets.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "fpbm_controllers/description.hpp"

namespace fpbm_controllers {

namespace {

using Vector = fpbm::Vector<3>;

/// A joint's axis at zero positions, in the base frame.
struct Axis {
  Vector point;
  Vector direction;
};

[[nodiscard]] std::vector<Axis> axes_of(const fpbm::Chain<>& chain) {
  std::vector<Axis> axes;
  fpbm::Transform<> frame;
  for (const auto& joint : chain.joints) {
    frame = frame * joint.placement;
    axes.push_back({frame.p, fpbm::times(frame.R, fpbm::normalized(joint.axis))});
  }
  return axes;
}

[[nodiscard]] double angle(const Axis& a, const Axis& b) {
  return std::atan2(fpbm::cross(a.direction, b.direction).norm(), a.direction.dot(b.direction));
}

/// Distance of two axes [m], with a sign unless the axes are parallel within 0.1 rad.
[[nodiscard]] double distance(const Axis& a, const Axis& b) {
  const Vector between = b.point - a.point;
  const Vector normal = fpbm::cross(a.direction, b.direction);
  const double sine = normal.norm();
  return sine > 0.1 ? between.dot(normal) / sine : fpbm::cross(between, a.direction).norm();
}

[[noreturn]] void reject(const std::string& joint, const std::string& what, double described, const std::string& name,
                         double preset) {
  std::ostringstream text;
  text << "arm: joint '" << joint << "': " << what << " is " << described << " in robot_description, and " << preset
       << " in " << name << ": give the preset of the robot, or remove arm and give limits.acceleration";
  throw std::invalid_argument(text.str());
}

}  // namespace

fpbm::Chain<> preset_chain(const std::string& name) {
  for (const auto& arm : fpbm::presets::kAll) {
    if (name == arm.name) return arm.chain();
  }
  throw std::invalid_argument("arm: is '" + name + "': must be a preset: correct the name");
}

void require_match(const fpbm::Chain<>& described, const std::string& tip, const std::string& name,
                   const fpbm::Chain<>& preset) {
  const std::size_t count = described.joints.size();
  if (preset.joints.size() != count) {
    throw std::invalid_argument("arm: " + name + " has " + std::to_string(preset.joints.size()) +
                                " joints, and robot_description " + std::to_string(count) +
                                " between base_frame and link '" + tip +
                                "': give the preset of the robot, or remove arm and give limits.acceleration");
  }
  const std::vector<Axis> ours = axes_of(described);
  const std::vector<Axis> theirs = axes_of(preset);
  for (std::size_t j = 0; j < count; ++j) {
    const auto& joint = described.joints[j];
    if (joint.mimic.joint >= 0) {
      throw std::invalid_argument("arm: joint '" + joint.name +
                                  "' follows another joint in robot_description, but not in " + name +
                                  ": give the preset of the robot, or remove arm and give limits.acceleration");
    }
    for (std::size_t i = 0; i < j; ++i) {
      const std::string other = " of its axis from the axis of joint '" + described.joints[i].name + "'";
      const auto differ = [&](const std::string& what, auto measure, double tolerance) {
        const double a = measure(ours[i], ours[j]);
        const double b = measure(theirs[i], theirs[j]);
        if (!(std::abs(a - b) <= tolerance)) reject(joint.name, what + other, a, name, b);
      };
      differ("the angle [rad]", angle, 0.05);
      differ("the distance [m]", distance, 0.02);
    }
    const auto exceed = [&](const char* what, double ours_is, double theirs_is) {
      if (std::isfinite(ours_is) && std::abs(ours_is) > 1.01 * std::abs(theirs_is) + 1e-3) {
        reject(joint.name, what, ours_is, name, theirs_is);
      }
    };
    const auto& bounds = preset.joints[j].bounds;
    exceed("the velocity limit", joint.bounds.velocity, bounds.velocity);
    exceed("the range", joint.bounds.upper - joint.bounds.lower, bounds.upper - bounds.lower);
  }
}

}  // namespace fpbm_controllers
