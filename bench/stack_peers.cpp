#include <cstdlib>

#include "stack_cascade.hpp"
#include "stack_time.hpp"

// A stack of tasks in C++: this library and cascades of quadratic programs, as JSON. See stack_peers.py.
namespace bench::stack {
namespace {

/// Largest differences from the kinematics of this library and from its motion of level 0, in states without active
/// bounds.
struct Difference {
  double kinematics = 0.0;
  double first = 0.0;   ///< Largest ‖J₀(u − u')‖ / ‖J₀u'‖.
  double second = 0.0;  ///< For level 1: the median, because this library damps the directions that level 0 uses.
};

template <typename Case, typename Solver>
Difference compare(Solver& solver, const std::vector<Asked<Case>>& states) {
  Ours<Case> ours;
  CascadeLevels<Case> levels;
  Difference result;
  std::vector<double> second;
  for (const Asked<Case>& asked : states) {
    Joints expected;
    Joints found;
    ours(asked, expected);
    solver(asked, found);
    levels.update(asked);
    const auto& rows = ours.kinematics().levels;
    auto J0 = std::get<0>(rows).J;
    J0.template bottomRows<Case::kRows - 3>() /= ours.kinematics().length;  // In radians.
    const double J = (J0 - levels.J0).cwiseAbs().maxCoeff() + (std::get<1>(rows).J - levels.J1).cwiseAbs().maxCoeff();
    result.kinematics = std::max(result.kinematics, J);
    const auto relative = [&](const auto& level) {
      return (level * (found - expected)).norm() / std::max((level * expected).norm(), 1e-2);
    };
    result.first = std::max(result.first, relative(levels.J0));
    second.push_back(relative(levels.J1));
  }
  result.second = quantile(second, 0.5);
  return result;
}

void print(const char* name, const Report& report, long unsolved) {
  std::printf("{\"name\": \"%s\", \"limited\": %d, \"unsolved\": %ld", name, report.limited, unsolved);
  std::printf(", \"position\": %.3g, \"velocity\": %.3g, \"acceleration\": %.3g", report.position, report.velocity,
              report.acceleration);
  std::printf(", \"position_active\": %d, \"velocity_active\": %d, \"acceleration_active\": %d", report.position_active,
              report.velocity_active, report.acceleration_active);
  double square = 0.0;
  for (const double error : report.error) square += error * error;
  std::printf(", \"error_rms\": %.5g, \"error_end\": %.3g, \"lacks_median\": %.4g, \"lacks_p90\": %.4g}",
              std::sqrt(square / static_cast<double>(report.error.size())), report.error.back(),
              quantile(report.residuals, 0.5), quantile(report.residuals, 0.9));
}

template <typename Case>
void run(int rounds, int passes, bool last) {
  Ours<Case> ours;
  Equalities<Case, Rt> equalities_rt;
  Equalities<Case, Fast> equalities_fast;
  NullSpaces<Case, Rt> null_spaces_rt;
  NullSpaces<Case, Fast> null_spaces_fast;
  const auto cascades = std::tie(equalities_rt, equalities_fast, null_spaces_rt, null_spaces_fast);

  std::printf("\"%s\": {\"motions\": [\n ", Case::name().c_str());
  std::vector<Asked<Case>> record;
  print(ours.name().c_str(), move(ours, record), 0);
  const auto each = [&](auto&& visit) { std::apply([&](auto&... cascade) { (visit(cascade), ...); }, cascades); };
  each([&](auto& cascade) {
    std::printf(",\n ");
    const Report report = move(cascade, record);
    print(cascade.name().c_str(), report, cascade.unsolved());
  });

  // From all motions, every 7th tick with active bounds, and every 7th tick without.
  std::array<std::vector<Asked<Case>>, 2> sets;
  std::array<std::size_t, 2> counts{};
  for (const Asked<Case>& asked : record) {
    const std::size_t set = ours.is_free(asked) ? 0 : 1;
    if (counts[set]++ % 7 == 0) sets[set].push_back(asked);
  }
  std::printf("],\n \"differences\": [");
  bool first = true;
  each([&](auto& cascade) {
    const Difference found = compare(cascade, sets[0]);
    std::printf("%s{\"name\": \"%s\", \"kinematics\": %.3g, \"first\": %.3g, \"second\": %.3g}", first ? "" : ",\n  ",
                cascade.name().c_str(), found.kinematics, found.first, found.second);
    first = false;
    if (!(found.kinematics < 1e-9 && found.first < 1e-4)) {
      std::fprintf(stderr, "%s: the kinematics differ by %g, level 0 by %g\n", cascade.name().c_str(), found.kinematics,
                   found.first);
      std::exit(EXIT_FAILURE);
    }
  });

  std::vector<Row<Case>> rows{{ours.name(), std::ref(ours)}};
  each([&](auto& cascade) { rows.push_back({cascade.name(), std::ref(cascade)}); });
  CascadeLevels<Case> levels;
  rows.push_back({"Pinocchio's kinematics and the commands", [&](const auto& asked, Joints& u) {
                    levels.update(asked);
                    u = levels.b2;
                  }});
  rows.push_back({"fpbm_cpp, without limits", [&](const auto& asked, Joints& u) {
                    ours.resolve(asked);
                    u = ours.desired();
                  }});
  for (std::size_t set = 0; set < 2; ++set) {
    std::printf("],\n \"%s\": [{\"states\": %zu}", set ? "limited" : "free", sets[set].size());
    const auto times = time_rows(rows, sets[set], rounds, passes);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::printf(",\n  ");
      print(rows[i].name, times[i], times[0]);
    }
  }
  std::printf("]}%s\n", last ? "" : ",");
  std::fflush(stdout);
}

}  // namespace
}  // namespace bench::stack

int main(int argc, char** argv) {
  using namespace bench::stack;
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 2000;
  const int passes = argc > 2 ? std::atoi(argv[2]) : 20;
  std::printf("{\n");
  run<TipPose>(rounds, passes, false);
  run<TipPosition>(rounds, passes, true);
  std::printf("}\n");
}
