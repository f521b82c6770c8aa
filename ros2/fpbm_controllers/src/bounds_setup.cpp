#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "fpbm_controllers/target_controller.hpp"
#include "fpbm_controllers/urdf_model.hpp"

namespace fpbm_controllers {

namespace {

using Capsules = std::vector<fpbm::LinkCapsule<>>;

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

/// The capsules of the parameters, on the links of a tree.
[[nodiscard]] Capsules given_capsules(const target_controller::Params& params, const fpbm::Tree<>& tree,
                                      const std::string& robot_description) {
  constexpr std::size_t kNumbers = 7;
  const std::vector<std::string>& links = params.clearance.links;
  const std::vector<double>& numbers = params.clearance.capsules;
  require(numbers.size() == kNumbers * links.size(), "clearance.capsules: has " + std::to_string(numbers.size()) +
                                                         " numbers: must have 7 for each of clearance.links, " +
                                                         std::to_string(kNumbers * links.size()));
  const urdf::Model model = model_of(robot_description);
  Capsules capsules;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto [name, link, place] = frame_of(tree, model, params.base_frame, {"clearance.links", links[i]});
    const double* const x = &numbers[kNumbers * i];
    const fpbm::Capsule<> capsule{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6]};
    capsules.push_back({link, fpbm::placed(capsule, place), name});
  }
  return capsules;
}

/// A bound on the coordinates of a position; `none` replaces an empty list.
[[nodiscard]] fpbm::Vector<3> corner(const std::string& name, const std::vector<double>& given, double none) {
  if (given.empty()) return fpbm::Vector<3>::Constant(none);
  require(given.size() == 3, name + ": has " + std::to_string(given.size()) + " entries: must have 3");
  for (const double each : given) require(!std::isnan(each), name + ": has an entry that is not a number: correct it");
  return {given[0], given[1], given[2]};
}

}  // namespace

ClearanceSettings TargetController::clearance_settings(const fpbm::Tree<>& tree) const {
  const auto& given = params_.clearance;
  ClearanceSettings settings{tree, {}, {}, given.margin, static_cast<std::size_t>(given.obstacles), params_.base_frame};
  if (given.links.empty()) {
    auto [capsules, never_collide] = preset_capsules(tree, get_robot_description(), params_.base_frame, params_.arm);
    settings.capsules = capsules;
    settings.allowed = never_collide;
  } else {
    settings.capsules = given_capsules(params_, tree, get_robot_description());
  }
  require(given.allowed.size() % 2 == 0, "clearance.allowed: has an odd number of names: give pairs of names");
  for (std::size_t i = 0; i < given.allowed.size(); i += 2) {
    settings.allowed.emplace_back(given.allowed[i], given.allowed[i + 1]);
  }
  return settings;
}

std::shared_ptr<TaskBounds> TargetController::task_bounds(const fpbm::Tree<>& tree) const {
  const urdf::Model model = model_of(get_robot_description());
  auto bounds = std::make_shared<TaskBounds>(tree);
  for (const std::string& name : params_.task_bounds) {
    const auto& given = params_.task_bound.task_bounds_map.at(name);
    const std::string prefix = "task_bound." + name + ".";
    const auto [frame, link, offset] = frame_of(tree, model, params_.base_frame, {prefix + "frame", given.frame});
    require(link > 0, prefix + "frame: no joint moves link '" + given.frame + "': give a link that moves");
    fpbm::PositionBounds<> bound{fpbm::LinkFrame<>(link, offset)};
    bound.name = name;
    bound.lower = corner(prefix + "lower", given.lower, -bound.kNone);
    bound.upper = corner(prefix + "upper", given.upper, bound.kNone);
    try {
      bounds->keep(bound);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(prefix + error.what());
    }
  }
  return bounds;
}

}  // namespace fpbm_controllers
