#pragma once

#include "fpbm/any/detail/any_frame_task.hpp"
#include "fpbm/any/detail/any_posture_task.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// Level of tasks that are known at run time: up to two tasks of frames and one posture task, with equal priority.
using AnyLevel = TaskLevel<AnyFrameTask, AnyFrameTask, AnyPostureTask>;

/// Stack of tasks that are known at run time. Levels without rows are ignored.
///
/// For programs that read the tasks at run time. AnyStack is a Stack with a fixed number of places for tasks. An empty
/// place is a task without rows.
using AnyStack = Stack<AnyLevel, AnyLevel, AnyLevel, AnyLevel>;

}  // namespace fpbm
