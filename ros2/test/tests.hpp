#pragma once

#include <robot.hpp>

/// Targets that come unevenly, none, and wrong ones; then locks of all interfaces, a held arm, activations.
void targets();
void faults(stand_in::Robot& robot);
/// Locks interfaces one by one, in motion and at deactivation.
void locks();
/// Update rates, asynchronous updates, and calls that come too soon.
void rates();
/// Starts of an arm that has an offset, lags behind, moves, or cannot be read.
void activation();
/// Arms and limits of robot_description, with every preset, with presets of other arms, and with a mimic joint.
void descriptions();
/// Subscriptions, stamps, and the node's life.
void topics();
/// Values of other types, misspelt names, numbers that are not finite.
void parameters();
/// Two arms side by side, each with a task: poses, twists, wrong messages, activations, a fault.
void two_arms();
/// Two arms with config/two_pandas.yaml: a grasp that a tray's motion and stop leave alone.
void grasp();
/// Tasks that are refused.
void tasks();
