#include <algorithm>
#include <cmath>
#include <cstdio>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <limits>
#include <random>
#include <std_msgs/msg/float64.hpp>
#include <string>
#include <utility>
#include <vector>

#include "stream_robot.hpp"
#include "tests.hpp"

namespace {

using diagnostic_msgs::msg::DiagnosticStatus;
using geometry_msgs::msg::PoseStamped;
using std_msgs::msg::Float64;

constexpr double kPi = 3.141592653589793;

/// Chunks at 10 Hz with jumps of up to 70 mrad, up to 90 ms late. Some chunks arrive after newer chunks, or are
/// invalid.
void chunks() {
  StreamRobot robot;
  check(robot.load() && robot.activate(), "chunks: activated", 1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jump(-0.07, 0.07);
  std::vector<std::pair<int, JointTrajectory>> late;
  const int before = stand_in::warnings;
  int invalid = 0;
  Posture last = kStart;
  for (int i = 0; i < 8000; ++i) {
    if (i % 100 == 0 && i < 7500) {
      const Posture offset = Posture::NullaryExpr([&] { return jump(random); });
      late.emplace_back(
          i + static_cast<int>(random() % 90),
          message(1e-3 * i, 20 + static_cast<int>(random() % 40), [&](double t) { return last = wave(t) + offset; }));
      if (i / 100 % 7 == 6) late.back().first += 150;
      auto& [due, sent] = late.back();
      auto& point = sent.points[random() % sent.points.size()];
      switch (i / 100 % 7) {
        case 1: point.positions[2] = std::numeric_limits<double>::quiet_NaN(); break;
        case 3: sent.joint_names[2] = "finger"; break;
        case 5:
          for (double& q : point.positions) q *= 57.3;
          break;
        default: --invalid;
      }
      ++invalid;
    }
    for (auto& [due, sent] : late) {
      if (due == i) robot.hear("~/joint_trajectory", sent);
    }
    robot.tick();
  }
  robot.tick(2000);
  check(stand_in::warnings == before + invalid && invalid > 20, "chunks: warnings of invalid messages", invalid);
  check(robot.from(last) < 1e-6, "chunks: distance from the last posture [rad]", robot.from(last));
  const auto status = robot.status();
  check(std::stoi(value(status, "targets rejected")) > 3, "chunks: rejected because of their stamps",
        std::stoi(value(status, "targets rejected")));
  check(std::stod(value(status, "age of the newest stamp [s]")) > 2.0, "chunks: age of the newest stamp [s]",
        std::stod(value(status, "age of the newest stamp [s]")));
  check(std::stod(value(status, "joint error [rad]")) < 1e-6, "chunks: error in the diagnostics [rad]",
        std::stod(value(status, "joint error [rad]")));
  const auto tip = fpbm_controllers::target_of(robot.said<PoseStamped>("~/tip_pose").last);
  check(tip && distance(tip->pose, robot.tip()) < 1e-6, "chunks: distance of tip_pose from the tip [m, rad]",
        tip ? distance(tip->pose, robot.tip()) : 1.0);
  limits_hold(robot, "chunks");
}

/// A posture with a time: the arm moves until this time, and not in minimum time.
void timed_posture() {
  StreamRobot robot;
  check(robot.load() && robot.activate(), "posture with a time: activated", 1);
  const Posture target = kStart + Posture::Constant(0.2);
  JointTrajectory sent = message(target);
  sent.points[0].time_from_start.sec = 1;
  robot.hear("~/joint_trajectory", sent);
  robot.tick(500);
  const double half = robot.from(target);
  check(0.05 < half && half < 0.15, "posture with a time: distance after half of the time [rad]", half);
  robot.tick(600);
  check(robot.from(target) < 1e-4, "posture with a time: distance after the time [rad]", robot.from(target));
  limits_hold(robot, "posture with a time");
}

/// A smooth stream is followed without a lag, with the velocities of the message or without. Prints the time of
/// update().
void smooth() {
  for (const bool moving : {false, true}) {
    StreamRobot robot;
    stand_in::parameters.stream.keep_path = moving ? 0.01 : 0.0;
    check(robot.load() && robot.activate(), "smooth chunks: activated", 1);
    double error = 0.0;
    std::vector<double> times;
    for (int i = 0; i < 3000; ++i) {
      if (i % 100 == 0) {
        JointTrajectory sent = message(1e-3 * i, 50, wave);
        for (std::size_t k = 0; k < sent.points.size() && moving; ++k) {
          sent.points[k].velocities.assign(7, 0.75 * std::sin(3.0 * (1e-3 * i + 0.02 * static_cast<double>(k))));
        }
        robot.hear("~/joint_trajectory", sent);
      }
      robot.tick();
      times.push_back(robot.seconds_of_call);
      if (i > 500) error = std::max(error, robot.from(wave(1e-3 * (i + 1))));
    }
    std::sort(times.begin(), times.end());
    std::printf("     update() [us]: median %.1f, p99.9 %.1f\n", 1e6 * times[1500], 1e6 * times[2997]);
    check(error < 1e-4, "smooth chunks: lag [rad]", error);
    limits_hold(robot, "smooth chunks");
  }
}

/// The largest acceleration after a chunk 1 mrad beside the chunk before [rad/s²].
double acceleration_of_a_correction(double blend) {
  StreamRobot robot;
  stand_in::parameters.stream.blend = blend;
  check(robot.load() && robot.activate(), "a chunk beside the last: activated", 1);
  const Posture beside = kStart + Posture::Constant(1e-3);
  robot.hear("~/joint_trajectory", message(0.0, 50, [](double) { return kStart; }));
  robot.tick(100);
  robot.hear("~/joint_trajectory", message(0.1, 50, [&](double) { return beside; }));
  double largest = 0.0;
  Posture before = robot.posture();
  Posture last = before;
  for (int i = 0; i < 500; ++i) {
    robot.tick();
    largest = std::max(largest, (robot.posture() - 2.0 * last + before).cwiseAbs().maxCoeff() / 1e-6);
    before = last;
    last = robot.posture();
  }
  check(robot.from(beside) < 1e-6, "a chunk beside the last: distance after 0.5 s [rad]", robot.from(beside));
  limits_hold(robot, "a chunk beside the last");
  return largest;
}

/// stream.blend reduces the accelerations of corrections.
void blend() {
  const double quickest = acceleration_of_a_correction(0.0);
  const double blended = acceleration_of_a_correction(0.2);
  check(quickest > 1.0, "blend 0: largest acceleration of a correction of 1 mrad [rad/s2]", quickest);
  check(blended < 0.05 * quickest, "blend 0.2: largest acceleration of a correction of 1 mrad [rad/s2]", blended);
}

/// Single postures at 50 Hz that end in motion.
void single() {
  StreamRobot robot(0.0, 0.04);
  check(robot.load() && robot.activate(), "single postures: activated", 1);
  std::mt19937 random(2);
  Float64MultiArray sent;
  double error = 0.0;
  for (int i = 0; i < 3000; ++i) {
    if (i % 20 == 0) {
      sent.data = list(wave(1e-3 * i));
      robot.hear("~/joint_positions", sent, rclcpp::SensorDataQoS());
    }
    robot.tick();
    if (i > 500) error = std::max(error, robot.from(wave(1e-3 * (i + 1) - 0.04)));
  }
  check(error < 1e-4, "single postures: distance from the posture 40 ms ago [rad]", error);
  check(robot.speed() > 0.2, "single postures: speed at the last message [rad/s]", robot.speed());
  robot.tick(1500);
  check(robot.speed() < 1e-6, "single postures: speed after the timeout [rad/s]", robot.speed());
  limits_hold(robot, "single postures");
}

/// A posture in a ball: the arm stops at the margin, and then follows the stream away from the ball.
void obstacle() {
  StreamRobot robot(kMargin);
  check(robot.load() && robot.activate(), "a stream with a ball: activated", 1);
  Posture turned = kStart;
  turned(0) = 1.2;
  const fpbm::Vector<3> ball =
      fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 1.2)) * (robot.tip().p + fpbm::Vector<3>(0.0, 0.0, 0.1));
  const Judge judge({fpbm::Obstacle<>("ball", fpbm::Capsule<>{ball, ball, 0.1})});
  robot.see(stand_in::scene({stand_in::sphere("ball", 0.1, ball)}));
  robot.hear("~/joint_trajectory", message(turned));
  const double nearest = least(robot, judge, 4000);
  check(nearest >= kMargin - kTolerance && nearest < kMargin + 1e-3, "a stream with a ball: least distance [m]",
        nearest);
  check(robot.from(turned) > 0.1, "a stream with a ball: distance from the posture in the ball [rad]",
        robot.from(turned));
  check(robot.status().level == DiagnosticStatus::WARN, "a stream with a ball: level of the diagnostics", 1);
  robot.hear("~/joint_trajectory", message(kStart));
  check(least(robot, judge, 6000) >= kMargin - kTolerance, "a stream with a ball: least distance on the return [m]", 1);
  check(robot.from(kStart) < 1e-6, "a stream with a ball: distance after the return [rad]", robot.from(kStart));
  limits_hold(robot, "a stream with a ball");
}

/// Closed path of the joints 1 and 4.
Posture loop(double phase) {
  Posture q = kStart;
  q(0) += 0.3 * (1.0 - std::cos(phase));
  q(3) += 0.15 * std::sin(phase);
  return q;
}

/// Largest distance of a joint from the nearest posture of the loop [rad].
double from_loop(const Posture& q) {
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 2000; ++k) {
    nearest = std::min(nearest, (q - loop(kPi * k / 1000.0)).cwiseAbs().maxCoeff());
  }
  return nearest;
}

/// The loop as a chunk of 2.4 s from a stamp [s] on, from rest to rest.
JointTrajectory loop_message(double stamp) {
  return message(stamp, 121, [stamp](double t) { return loop(kPi * (1.0 - std::cos(kPi * (t - stamp) / 2.4))); });
}

/// A ball at the farthest point of the loop.
stand_in::PlanningScene ball_on_loop(const StreamRobot& robot) {
  const fpbm::Vector<3> centre =
      fpbm::rotation(fpbm::Vector<3>(0.0, 0.0, 0.6)) * (robot.tip().p + fpbm::Vector<3>(0.0, 0.0, 0.1));
  return stand_in::scene({stand_in::sphere("ball", 0.1, centre)});
}

/// The largest distance from the loop of an arm that a ball blocks for 3 s [rad].
double deviation(double keep_path) {
  StreamRobot robot(kMargin);
  stand_in::parameters.stream.keep_path = keep_path;
  check(robot.load() && robot.activate(), "a blocked path: activated", 1);
  robot.see(ball_on_loop(robot));
  robot.hear("~/joint_trajectory", loop_message(0.0));
  double largest = 0.0;
  double farthest = 0.0;
  for (int i = 0; i < 9000; ++i) {
    if (i == 3000) robot.see(stand_in::scene({}, false));
    robot.tick();
    largest = std::max(largest, from_loop(robot.posture()));
    farthest = std::max(farthest, robot.command[0]);
  }
  check((farthest > 0.59) == (keep_path > 0.0), "a blocked path: farthest posture of joint 1, 0.6 [rad]", farthest);
  check(robot.from(kStart) < 1e-6, "a blocked path: distance from the end [rad]", robot.from(kStart));
  limits_hold(robot, "a blocked path");
  return largest;
}

/// Motion that does not reach the ball.
Posture swing(double t) {
  return kStart - Posture::Unit(0) * 0.25 * (1.0 - std::cos(3.0 * (t - 5.0)));
}

/// With stream.keep_path, the reference waits on the path while a ball blocks the arm. A message ends the wait, and
/// later chunks are followed without a lag.
void kept_path() {
  const double cut = deviation(0.0);
  const double kept = deviation(0.01);
  check(cut > 0.1, "without keep_path: largest distance from the path [rad]", cut);
  check(kept < 0.012, "keep_path 0.01: largest distance from the path [rad]", kept);
  StreamRobot robot(kMargin);
  stand_in::parameters.stream.keep_path = 0.01;
  check(robot.load() && robot.activate(), "a message ends a wait: activated", 1);
  robot.see(ball_on_loop(robot));
  robot.hear("~/joint_trajectory", loop_message(0.0));
  robot.tick(5000);
  check(robot.speed() < 1e-6 && robot.from(kStart) > 0.1, "a message ends a wait: distance before [rad]",
        robot.from(kStart));
  const double age = std::stod(value(robot.status(), "age of the newest stamp [s]"));
  check(std::abs(age - 5.0) < 0.01, "a message ends a wait: age of the newest stamp [s]", age);
  double error = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const double now = 5.0 + 1e-3 * i;
    if (i % 100 == 0) robot.hear("~/joint_trajectory", message(now, 50, swing));
    robot.tick();
    if (i > 4000) error = std::max(error, robot.from(swing(now + 1e-3)));
  }
  const int rejected = std::stoi(value(robot.status(), "targets rejected"));
  check(rejected == 0, "a message ends a wait: rejected because of their stamps", rejected);
  check(error < 1e-4, "a message ends a wait: lag of later chunks [rad]", error);
  limits_hold(robot, "a message ends a wait");
}

/// Activation, the speed, a lock and a fault. After each restart, the arm holds its posture until the next message.
void restarts() {
  StreamRobot robot;
  Posture turned = kStart;
  turned(0) = 1.0;
  check(robot.load(), "restarts: configured", 1);
  robot.hear("~/joint_trajectory", message(turned));
  check(robot.activate(), "restarts: activated", 1);
  robot.tick(500);
  check(robot.from(kStart) == 0.0, "restarts: motion by a message before the activation [rad]", robot.from(kStart));
  Float64 slow;
  slow.data = 0.1;
  robot.hear("~/speed", slow);
  robot.hear("~/joint_trajectory", message(turned));
  robot.tick(1000);
  check(0.16 < robot.speed() && robot.speed() < 0.1741, "restarts: velocity, bound 0.174 [rad/s]", robot.speed());
  robot.command_locks[1].calls = 2;
  robot.tick(3);
  const Posture held = robot.posture();
  robot.tick(1000);
  check(robot.from(held) < 1e-9, "restarts: motion after a lock [rad]", robot.from(held));
  slow.data = 1.0;
  robot.hear("~/speed", slow);
  robot.hear("~/joint_trajectory", message(turned));
  robot.tick(3000);
  check(robot.from(turned) < 1e-6, "restarts: distance from a posture after the lock [rad]", robot.from(turned));
  robot.hear("~/joint_trajectory", message(kStart));
  robot.held = true;
  robot.tick(1500);
  check(robot.speed() == 0.0 && robot.status().level == DiagnosticStatus::ERROR, "restarts: speed after a fault",
        robot.speed());
  check(robot.command[0] > 0.5, "restarts: command of joint 1 after a fault, from 1 toward 0 [rad]", robot.command[0]);
  limits_hold(robot, "restarts");
}

}  // namespace

void streams() {
  chunks();
  timed_posture();
  smooth();
  blend();
  single();
  obstacle();
  kept_path();
  restarts();
}
