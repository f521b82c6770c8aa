#pragma once

#include <robot.hpp>

/// Locks the interfaces, holds the arm, deactivates and activates the controller.
void faults(stand_in::Robot& robot);
