#pragma once

#include "fpbm/any/any_frame_task.hpp"
#include "fpbm/any/any_posture_task.hpp"
#include "fpbm/task/stack.hpp"

namespace fpbm {

/// A level of tasks that are known at run time: up to two of frames and one of joints, side by side.
using AnyLevel = TaskLevel<AnyFrameTask, AnyFrameTask, AnyPostureTask>;

/// A stack of tasks that are known at run time. Levels without rows are left out.
///
/// For programs that learn their tasks at run time. Is a Stack itself, of places for tasks: where a place is empty, its
/// task has no rows.
using AnyStack = Stack<AnyLevel, AnyLevel, AnyLevel, AnyLevel>;

}  // namespace fpbm
