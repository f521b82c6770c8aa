#pragma once

#include <robot.hpp>

/// Irregular streams of targets with a gap, and invalid targets. Then locks of all interfaces, a held arm, activations.
void targets();
void faults(stand_in::Robot& robot);
/// Locks interfaces one by one, in motion and at deactivation.
void locks();
/// Update rates, asynchronous updates, and calls that are too early.
void rates();
/// Activations of an arm with an offset, with a lag, in motion, and with invalid readings.
void activation();
/// Arms and limits from robot_description, with every preset, with presets of other arms, and with a mimic joint.
void descriptions();
/// The command interface effort: a simulated arm with other masses, feed-forward torques, faults, and refusals.
void efforts();
/// Subscriptions, stamps, and the lifecycle of the node.
void topics();
/// Parameters with values of other types, misspelt names, and numbers that are not finite.
void parameters();
/// Self-collision: margins, capsules, two arms, and refusals.
void clearance();
/// Obstacles of planning scenes: margins, operations, obstacles that are too close, and locks.
void obstacles();
/// Bounds on the torques of the commanded motion, with a payload of an uncertain mass.
void torque_bounds();
/// Bounds on the positions of links.
void task_bounds();
/// Prints the time of update(), without and with bounds.
void update_time();
/// Streams of joint positions: chunks with jumps, single postures, a clearance, locks, and a fault.
void streams();
/// Messages and parameters of streams that are rejected.
void joint_messages();
/// Two arms side by side, each with a task: poses, twists, invalid messages, activations, and a fault.
void two_arms();
/// Two arms with config/two_pandas.yaml: motions and a stop of the tray do not change the grasp.
void grasp();
/// Tasks that the controller accepts or rejects.
void tasks();
/// The texts of errors, warnings and diagnostics.
void wording();
