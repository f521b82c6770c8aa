#include "fpbm/core/lanes.hpp"

#include <cstddef>

#include "step.hpp"

// Steps of several arms in parallel, one arm in each SIMD lane, compiled for one type of processor. Rows:
// part/arm/task/scheme/kind. Each arm counts as a call.
namespace bench {

constexpr int kLanes = static_cast<int>(std::experimental::native_simd<double>::size());
using InLanes = fpbm::Lanes<kLanes>;

template <typename All, typename One>
void set_lane(All& all, std::size_t lane, const One& one) {
  for (Eigen::Index i = 0; i < one.size(); ++i) all(i)[lane] = one(i);
}
inline void set_lane(fpbm::Transform<InLanes>& all, std::size_t lane, const fpbm::Transform<>& one) {
  set_lane(all.p, lane, one.p);
  set_lane(all.R, lane, one.R);
}

/// The states of a single arm, distributed to the lanes.
template <typename Robot, typename Space>
auto inputs(Case<Robot, Space, InLanes>) {
  const auto each = inputs(Case<Robot, Space>{});
  std::array<Input<Space, Robot::kDof, InLanes>, each.size() / kLanes> result;
  for (std::size_t i = 0; i < each.size(); ++i) {
    auto& [state, reference] = result[i / kLanes];
    const std::size_t lane = i % kLanes;
    set_lane(state.q, lane, each[i].state.q);
    set_lane(state.qd, lane, each[i].state.qd);
    set_lane(reference.x, lane, each[i].reference.x);
    set_lane(reference.xd, lane, each[i].reference.xd);
    set_lane(reference.xdd, lane, each[i].reference.xdd);
  }
  return result;
}

namespace {

/// Stops if the result of an arm differs from the result of a single arm by more than 1e-12.
template <typename Robot, typename Space>
void require_agreement_in_lanes(const std::string& row) {
  Ours<Case<Robot, Space>, Law::kFPBM> alone;
  Ours<Case<Robot, Space, InLanes>, Law::kFPBM> side_by_side;
  const auto each = inputs(Case<Robot, Space>{});
  std::size_t i = 0;
  for (const auto& input : inputs(Case<Robot, Space, InLanes>{})) {
    fpbm::Vector<Robot::kDof, InLanes> found;
    side_by_side.move(input);
    bool solved = side_by_side.resolve(input, found) == fpbm::Status::kOk;
    for (std::size_t lane = 0; lane < kLanes; ++lane, ++i) {
      fpbm::Vector<Robot::kDof> expected;
      alone.move(each[i]);
      solved = alone.resolve(each[i], expected) == fpbm::Status::kOk && solved;
      const auto difference = found.unaryExpr([lane](const InLanes& x) -> double { return x[lane]; }) - expected;
      if (!solved || !(difference.norm() <= 1e-12 * expected.norm())) {
        std::fprintf(stderr, "%s: the result differs by %g\n", row.c_str(), difference.norm() / expected.norm());
        std::exit(EXIT_FAILURE);
      }
    }
  }
}

template <typename Job>
void run_in_lanes(benchmark::State& bench) {
  Job job;
  escape(job);
  while (bench.KeepRunningBatch(kLanes)) job();
  bench.SetItemsProcessed(bench.iterations());
}

template <typename Robot, typename Space>
bool add() {
  using Wide = Case<Robot, Space, InLanes>;
  using Solver = Ours<Wide, Law::kFPBM>;
  const std::string step = "step/" + Wide::name() + "/fpbm/" FPBM_KIND;
  require_agreement_in_lanes<Robot, Space>(step);
  benchmark::RegisterBenchmark(step.c_str(), run_in_lanes<Step<Solver>>);
  const std::string kinematics = "kinematics/" + Wide::name() + "/acceleration/" FPBM_KIND;
  benchmark::RegisterBenchmark(kinematics.c_str(), run_in_lanes<Move<Solver>>);
  return true;
}

[[maybe_unused]] const bool kAdded = add<Panda, fpbm::Pose>() && add<Planar<4>, fpbm::Position<2>>();

}  // namespace
}  // namespace bench
