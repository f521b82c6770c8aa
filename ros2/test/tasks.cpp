#include <string>
#include <two_arms.hpp>

#include "check.hpp"
#include "tests.hpp"

namespace {

using stand_in::TwoArms;

/// Parameters of two arms with a task "left" for the left flange.
class Given {
 public:
  Given() {
    add("left", "left_flange");
    own.joints.resize(7);
  }
  Given& add(const std::string& name, const std::string& frame, int level = 1, const std::string& reference = "") {
    own.tasks.push_back(name);
    auto& task = own.task.tasks_map[name];
    task.frame = frame;
    task.reference_frame = reference;
    task.level = level;
    return *this;
  }
  /// Adds the joints of the right arm.
  Given& both() {
    for (int i = 1; i < 8; ++i) own.joints.push_back("right_panda_joint" + std::to_string(i));
    return *this;
  }
  void refused(const std::string& what, const std::string& text) {
    (void)logged("");
    const bool loaded = robot_.load();
    const bool named = logged(text);
    check(!loaded && named, (what + (loaded ? ": accepted" : ": refused, with the reason")).c_str(), named);
  }
  void accepted(const std::string& what) { check(robot_.load(), what.c_str(), 1); }

  target_controller::Params& own = stand_in::parameters;

 private:
  TwoArms robot_;
};

}  // namespace

void tasks() {
  Given().accepted("a task of one arm of two: accepted");
  Given().both().add("right", "right_flange").accepted("two tasks: accepted");
  Given().add("elbow", "link_of_left_panda_joint4", 3).accepted("a level without tasks is left out");
  Given().add("in_table", "left_flange", 2, "right_base").accepted("a reference frame that is fixed to the base");

  Given().add("tool", "").refused("no frame", "task.tool.frame: is empty");
  Given().add("tool", "hand").refused("an unknown link", "task.tool.frame: robot_description has no link 'hand'");
  Given().add("tool", "left_flange", 1, "hand").refused("an unknown reference", "task.tool.reference_frame: robot_");
  Given().add("tool", "left_flange", 1, "left_flange").refused("its own frame", "task.tool.reference_frame: is 'left_");
  Given()
      .add("tool", "left_flange", 1, "link_of_left_panda_joint7")
      .refused("a reference that moves with the frame", "no joint moves link 'left_flange' relative to link");
  Given()
      .add("tool", "right_base")
      .refused("a frame that no joint moves", "no joint moves link 'right_base' relative to");
  Given().add("tool", "left_flange", 5).refused("level 5", "task.tool.level: is 5: must be from 1");
  Given().add("tool", "left_flange", 0).refused("level 0", "task.tool.level: is 0: must be from 1");
  Given()
      .both()
      .add("right", "right_flange")
      .add("third", "right_flange")
      .refused("three tasks on a level", "task.third.level: level 1 already has 2 tasks");
  Given()
      .add("tool", "left_flange")
      .refused("two poses of one arm on a level", "task.tool.level: the poses of level 1");
  Given a_tip;
  a_tip.own.tip_frame = "left_flange";
  a_tip.refused("tip_frame and tasks", "tip_frame: is 'left_flange', but tasks are given");
  Given a_tool;
  a_tool.own.tool.xyz = {0.0, 0.0, 0.1};
  a_tool.refused("a tool and tasks", "tool: is only for tip_frame");
  Given neither;
  neither.own.tasks.clear();
  neither.refused("neither tip_frame nor tasks", "tip_frame: is empty, and there are no tasks");
  Given low;
  low.own.task.tasks_map["left"].level = 2;
  low.refused("no task on level 1", "tasks: no task has level 1");
  Given().add("left hand", "left_flange", 2).refused("a name with a space", "tasks: 'left hand' is not a name");
  Given swapped;
  swapped.both().add("right", "right_flange");
  std::swap(swapped.own.tasks[0], swapped.own.tasks[1]);
  swapped.refused("joints in another order than the tasks'",
                  "joints: joint 1 is 'left_panda_joint1', and 'right_panda_joint1' in robot_description between "
                  "base_frame and the frames: give [right_panda_joint1, right_panda_joint2, ");
  Given another;
  another.both().add("right", "right_flange").own.arm = "fr3";
  another.refused("the preset of another arm", "joint 'left_panda_joint");
  Given unbounded;
  unbounded.own.arm = "";
  unbounded.refused("no preset", "limits.acceleration: joint 'left_panda_joint1'");
  Given stiff;
  stiff.own.task.tasks_map["left"].k1 = 5000.0;
  stiff.refused("a gain that the tick does not damp", "task.left.k1 = 5000: must be at most");
  Given by_levels;
  by_levels.add("elbow", "link_of_left_panda_joint4", 2).own.scheme.null_damping = 1500.0;
  by_levels.refused("a null_damping that a tick of two tasks does not damp", "null_damping = 1500: must be at most");
}
