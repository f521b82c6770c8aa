#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "fpbm/bound/bounds.hpp"
#include "fpbm/bound/detail/torque_deviation.hpp"
#include "fpbm/model/dynamics.hpp"

namespace fpbm {

/// Bound of a Tracker at acceleration level: |τ_i| ≤ effort_i for the torques of inverse dynamics, at the start and at
/// the end of every tick (docs/torques.md).
///
/// A tick is accepted only if the torques of the whole stopping trajectory after the tick are proved to keep the bound.
/// The torques are evaluated at a few moments. Between two evaluations, TorqueDeviation bounds the torques.
template <int N, typename Scalar_ = double, int Joints = N>
class TorqueBounds {
 public:
  using Scalar = Scalar_;
  using JointVector = Vector<N, Scalar>;
  using JointMatrix = Matrix<N, N, Scalar>;
  using Model = Dynamics<N, Scalar, Joints>;
  static constexpr int kRows = N == Eigen::Dynamic || N > 8 ? 16 : 2 * N;
  static constexpr Status kStatus = Status::kSlowed;

  /// source: the Tree or the Chain of the robot. effort: bounds [Nm] or [N], infinite if there is no bound.
  template <typename Source>
  TorqueBounds(const Source& source, const JointVector& effort)
      : model_(source), deviation_(source, model_), effort_(effort) {
    validation::require_size("effort", effort.size(), model_.dof());
  }

  [[nodiscard]] const Model& model() const noexcept { return model_; }
  [[nodiscard]] bool empty() const noexcept {
    for (Eigen::Index i = 0; i < effort_.size(); ++i) {
      if (std::isfinite(effort_(i))) return false;
    }
    return true;
  }

  /// Throws std::invalid_argument if the arm cannot hold the posture q.
  void require(const JointVector& q) {
    const JointVector g = (set(here_, {q, filled<JointVector>(q.size())}), here_.h);
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      if (std::abs(g(i)) > effort_(i)) {
        validation::reject(validation::element("q", i), ": the torque at rest, ", g(i), ", exceeds the bound ", effort_(i));
      }
    }
  }

  template <Level kLevel, int P>
  void rows(const NextMotion<kLevel, N, Scalar>& next, Rows<N, P, Scalar>& rows) noexcept {
    evaluations = 0;
    set(here_, next.state);
    const Scalar h = next.limits.tick();
    set(there_, {JointVector(next.state.q + h * next.state.qd + h * h / Scalar(2) * next.u), JointVector(next.state.qd + h * next.u)});
    const Eigen::Index most = rows.count + kRows;
    const JointVector& a = next.limits.bounds().acceleration;
    const JointVector now = here_.torque(next.u);
    const JointVector later = there_.torque(next.u);
    for (Eigen::Index i = 0; i < now.size(); ++i) {
      const Scalar reach = std::abs(here_.h(i)) + here_.M.row(i).cwiseAbs().dot(a);
      if (reach <= Scalar(0.95) * effort_(i)) continue;
      for (const Scalar sign : {Scalar(1), Scalar(-1)}) {
        if (rows.count == most) return;
        const Node& node = sign * now(i) > sign * later(i) ? here_ : there_;
        rows.g.col(rows.count) = sign * node.M.row(i).transpose();
        rows.b(rows.count++) = (Scalar(1) - kSlack) * effort_(i) - sign * node.h(i);
      }
    }
  }

  template <Level kLevel>
  [[nodiscard]] bool accepts(const Limits<kLevel, N, Scalar>& limits, const State<N, Scalar>& from,
                             const Stop<kLevel, N, Scalar>& stop) noexcept {
    admitted_ = Scalar(0);
    if (!is_finite(stop.start.qd)) return false;
    const JointVector& u = stop.plan.last();
    set(here_, from);
    if (!within(here_.torque(u), filled<JointVector>(u.size()))) {kinds[0]++; return false;}
    set(there_, stop.start);
    if (!within(there_.torque(u), filled<JointVector>(u.size()))) {kinds[1]++;return false;}
    auto plan = stop.plan;
    StopPart<N, Scalar> part;
    Node* start = &there_;
    Node* end = &next_;
    JointVector last = u;
    const Scalar h = limits.tick();
    while (plan.ticks_left() > Scalar(0)) {
      Scalar ticks = std::min(plan.phase_ticks(), plan.ticks_left());
      for (;;) {
        auto ahead = plan;
        part.state = start->state;
        part.last = last;
        part.speed = last;
        ahead.advance(limits, ticks, part);
        part.turned = deviation_.turned(plan.velocity(), part.along);
        const JointVector middle = (part.low + part.high) / Scalar(2);
        const JointVector half = (part.high - part.low) / Scalar(2);
        const JointVector deviation = ticks > Scalar(1) ? deviation_.of(part, ticks * h) : filled<JointVector>(u.size());
        const auto keeps = [&](const Node& node) {
          return within(node.torque(middle), node.spread(half) + deviation);
        };
        if (keeps(*start)) {
          if (++evaluations > 60) { ++stats[0]; if (part.along == Scalar(0)) ++stats[1]; return false; }
          set(*end, part.state);
          if (!within(end->torque(part.last), filled<JointVector>(u.size()))) {
            admitted_ = admitted(*end, part.last);
            ++stats[2]; kinds[admitted_>0?2:3]++; return false;
          }
          if (keeps(*end)) {
            std::swap(start, end);
            plan = ahead;
            last = part.last;
            break;
          }
        }
        if (!(ticks > Scalar(1))) {
          ++stats[2]; if (part.along == Scalar(0)) ++stats[3];
          admitted_ = admitted(*start, middle); kinds[admitted_>0?4:5]++;
          return false;
        }
        ticks = std::floor(ticks / Scalar(2));
      }
    }
    return true;
  }
  int evaluations = 0;
  long stats[4] = {};
  long kinds[8] = {};
  [[nodiscard]] Scalar slower_stop(Scalar fraction) const noexcept {
    const Scalar slower = fraction * std::min(Scalar(0.7) * admitted_, Scalar(0.8));
    if (slower <= Scalar(1e-3)) const_cast<long*>(kinds)[6]++;
    return slower > Scalar(1e-3) ? slower : Scalar(0);
  }

 private:
  static constexpr Scalar kSlack = Scalar(0.002);
  struct Node {
    State<N, Scalar> state;
    JointVector h;
    JointMatrix M;
    [[nodiscard]] JointVector torque(const JointVector& u) const noexcept { return h + M * u; }
    [[nodiscard]] JointVector spread(const JointVector& half) const noexcept { return M.cwiseAbs() * half; }
  };

  /// Largest fraction of the accelerations u with which the torques keep the bound.
  [[nodiscard]] Scalar admitted(const Node& node, const JointVector& u) const noexcept {
    const JointVector t = node.M * u;
    Scalar fraction(1);
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const Scalar slack = effort_(i) - (t(i) > Scalar(0) ? node.h(i) : -node.h(i));
      if (std::abs(t(i)) * fraction > slack) fraction = slack > Scalar(0) ? slack / std::abs(t(i)) : Scalar(0);
    }
    return fraction;
  }
  void set(Node& node, const State<N, Scalar>& state) noexcept {
    if (node.state.q.size() == state.q.size() && node.state.q == state.q && node.state.qd == state.qd) return;
    node.state = state;
    model_.robot().update(state.q, state.qd, robot_state_);
    node.h = model_.bias(robot_state_);
    node.M = model_.mass_matrix(robot_state_);
  }
  [[nodiscard]] bool within(const JointVector& torque, const JointVector& more) const noexcept {
    for (Eigen::Index i = 0; i < torque.size(); ++i) {
      if (!(std::abs(torque(i)) + more(i) <= effort_(i))) return false;
    }
    return true;
  }

  Model model_;
  TorqueDeviation<N, Scalar, Joints> deviation_;
  JointVector effort_;
  typename Model::State robot_state_;
  Node here_, there_, next_;
  Scalar admitted_ = Scalar(0);
};

}  // namespace fpbm
