#include "fpbm_controllers/task_settings.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <stdexcept>

namespace fpbm_controllers {

namespace {

constexpr int kLevels = 4;    // Levels of an fpbm::AnyStack,
constexpr int kPerLevel = 2;  // and tasks of frames on each level.

void require(bool good, const std::string& message) {
  if (!good) throw std::invalid_argument(message);
}

/// A token of a topic's name.
[[nodiscard]] bool is_token(const std::string& name) {
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
         std::all_of(name.begin(), name.end(), fits);
}

[[nodiscard]] TaskSettings of_tip(const target_controller::Params& params) {
  require(!params.tip_frame.empty(),
          "tip_frame: is empty, and there are no tasks: give the link that carries the tool, or tasks");
  return {"", params.tip_frame, "", 0, params.scheme.k1, params.scheme.k2};
}

[[nodiscard]] TaskSettings named(const target_controller::Params& params, const std::string& name) {
  require(is_token(name), "tasks: '" + name +
                              "' is not a name for topics: give letters, digits and underscores, and no digit at the "
                              "beginning");
  const auto& given = params.task.tasks_map.at(name);
  TaskSettings task{name,
                    given.frame,
                    given.reference_frame,
                    static_cast<int>(std::clamp<std::int64_t>(given.level, 0, kLevels + 1)) - 1,
                    given.k1 > 0.0 ? given.k1 : params.scheme.k1,
                    given.k2 > 0.0 ? given.k2 : params.scheme.k2};
  require(!task.frame.empty(), task.frame_parameter() + ": is empty: give the link that the task moves");
  require(task.frame != task.reference, task.parameter("reference_frame") + ": is '" + task.reference +
                                            "', the task's own frame: give another link, or no link for base_frame");
  require(1 <= given.level && given.level <= kLevels,
          task.parameter("level") + ": is " + std::to_string(given.level) + ": must be from 1, the highest, to " +
              std::to_string(kLevels) + ": put the task on one of these levels");
  return task;
}

}  // namespace

std::vector<TaskSettings> task_settings(const target_controller::Params& params) {
  if (params.tasks.empty()) return {of_tip(params)};
  require(params.input == "poses",
          "tasks: is not empty, but input is 'joints': remove tasks and give tip_frame, or set input to 'poses'");
  require(params.tip_frame.empty(), "tip_frame: is '" + params.tip_frame +
                                        "', but tasks are given: remove tip_frame, and give each task its frame");
  const auto is_zero = [](double x) { return x == 0.0; };
  const auto& [xyz, rpy] = params.tool;
  require(std::all_of(xyz.begin(), xyz.end(), is_zero) && std::all_of(rpy.begin(), rpy.end(), is_zero),
          "tool: is only for tip_frame, but tasks are given: remove tool, and give each task a link at its tool");
  std::vector<TaskSettings> tasks;
  std::array<int, kLevels> counts{};
  for (const std::string& name : params.tasks) {
    tasks.push_back(named(params, name));
    const TaskSettings& task = tasks.back();
    require(++counts[static_cast<std::size_t>(task.level)] <= kPerLevel,
            task.parameter("level") + ": level " + std::to_string(task.level + 1) + " already has " +
                std::to_string(kPerLevel) + " tasks, the largest number: put the task on another level");
  }
  require(counts[0] > 0, "tasks: no task has level 1: set the level of at least one task to 1, the highest priority");
  return tasks;
}

}  // namespace fpbm_controllers
