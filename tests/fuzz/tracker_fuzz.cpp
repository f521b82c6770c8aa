// Makes states, references, options and limits of arbitrary bytes, and checks the promises of the tracker and the
// schemes: no crash, no NaN or infinity in a result, no bound violated from a viable start, the same bits for the same
// input, and a tick without an error as soon as the reference is valid again.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fpbm/any/make_arm.hpp>
#include <fpbm/fpbm.hpp>

#include "bytes.hpp"

namespace {

void require(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "broken promise: %s\n", what);
  std::abort();
}

template <typename Derived>
bool same_bits(const Eigen::MatrixBase<Derived>& a, const Eigen::MatrixBase<Derived>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.derived().data(), b.derived().data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

template <typename Result>
void require_same(const Result& a, const Result& b) {
  require(same_bits(a.q, b.q) && same_bits(a.qd, b.qd) && same_bits(a.qdd, b.qdd) && same_bits(a.error, b.error) &&
              same_bits(a.scale, b.scale) && a.status == b.status && a.saturated == b.saturated,
          "the same input gives the same bits");
}

/// Checks that hold for every result and every input.
template <typename Result>
void require_sane(const Result& result) {
  require(result.qdd.allFinite(), "accelerations are finite");
  require(result.status <= fpbm::Status::kNotFinite && *fpbm::message(result.status) != '\0', "the status is one");
  require(result.scale >= 0.0 && result.scale <= 1.0, "the scale is a share");
  require((result.saturated >> result.q.size()) == 0, "only joints that there are lie on bounds");
}

/// Checks bounds, up to round-off.
template <int N>
struct Keeper {
  fpbm::JointLimits<N> bounds;
  double tick;

  static constexpr double kSlack = 1e-9;

  void require_kept(const fpbm::State<N>& from, const fpbm::Vector<N>& last, const fpbm::Vector<N>& q,
                    const fpbm::Vector<N>& qd, const fpbm::Vector<N>& qdd, bool evenly) const {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      require(q(i) <= bounds.upper(i) + kSlack && q(i) >= bounds.lower(i) - kSlack, "positions keep their bounds");
      require(std::abs(qd(i)) <= bounds.velocity(i) + kSlack, "velocities keep their bounds");
      // Round-off of a difference of velocities over a tick.
      const double rounding = 1e-15 * (std::abs(qd(i)) + std::abs(from.qd(i))) / tick;
      require(std::abs(qdd(i)) <= bounds.acceleration(i) * (1.0 + kSlack) + kSlack + rounding,
              "accelerations keep their bounds");
      require(std::abs(qdd(i) - last(i)) <= bounds.jerk(i) * tick * (1.0 + kSlack) + kSlack + rounding,
              "jerks keep their bounds");
      if (evenly && from.qd(i) * qd(i) < 0.0) {
        const double turn = from.q(i) - from.qd(i) * from.qd(i) / (2.0 * (qd(i) - from.qd(i)) / tick);
        require(turn <= bounds.upper(i) + kSlack && turn >= bounds.lower(i) - kSlack, "no joint turns beyond a bound");
      }
    }
  }
};

template <typename Space>
fpbm::Reference<Space> any_reference(Bytes& bytes, const typename Space::template Point<double>& near) {
  fpbm::Vector<Space::kRows> displacement, xd, xdd;
  const bool far = bytes.chance(64);
  bytes.fill(displacement, far ? -10.0 : -0.01, far ? 10.0 : 0.01);
  bytes.fill(xd, -1.0, 1.0);
  bytes.fill(xdd, -10.0, 10.0);
  return {Space::template displace<double>(near, displacement), xd, xdd};
}

/// Usual bounds, some of them infinite; rarely any bounds, which makes the case wild.
template <int N>
fpbm::JointLimits<N> any_limits(Bytes& bytes, Eigen::Index dof, bool& wild) {
  auto limits = fpbm::JointLimits<N>::none(dof);
  const double none = fpbm::JointBounds<>::kNone;
  for (Eigen::Index i = 0; i < dof; ++i) {
    const std::uint8_t which = bytes.byte();
    const double middle = bytes.within(-2.0, 2.0);
    const double half = bytes.spread(1e-3, 10.0);
    limits.set(i,
               {(which & 1) != 0 ? middle - half : -none, (which & 2) != 0 ? middle + half : none,
                (which & 4) != 0 ? bytes.spread(1e-3, 100.0) : none, (which & 24) != 0 ? bytes.spread(1e-2, 1e3) : none,
                (which & 32) != 0 ? bytes.spread(1.0, 1e6) : none, (which & 64) != 0 ? bytes.spread(1e-3, 1.0) : 0.0,
                (which & 192) == 192 ? bytes.spread(0.1, 100.0) : none});
  }
  if (bytes.chance(4)) {
    wild = true;
    limits.set(bytes.byte() % dof, {bytes.any(), bytes.any(), bytes.any(), bytes.any(), bytes.any()});
  }
  return limits;
}

/// Mostly within the bounds, and slow enough to stay there.
template <int N>
fpbm::State<N> any_start(Bytes& bytes, const fpbm::JointLimits<N>& limits, bool& wild) {
  const Eigen::Index dof = limits.lower.size();
  fpbm::State<N> start{fpbm::Vector<N>::Zero(dof), fpbm::Vector<N>::Zero(dof)};
  for (Eigen::Index i = 0; i < dof; ++i) {
    const double lower = std::isfinite(limits.lower(i)) ? limits.lower(i) : std::min(-3.0, limits.upper(i) - 6.0);
    const double upper = std::isfinite(limits.upper(i)) ? limits.upper(i) : std::max(3.0, lower + 6.0);
    start.q(i) = bytes.within(lower, upper);
    if (bytes.chance(128)) continue;
    const double distance = std::min(limits.upper(i) - start.q(i), start.q(i) - limits.lower(i));
    const double fastest = std::min({limits.velocity(i), std::sqrt(2.0 * limits.acceleration(i) * distance), 10.0});
    start.qd(i) = fastest * bytes.within(-1.0, 1.0);
  }
  if (bytes.chance(4)) {
    wild = true;
    bytes.fill(start.q, -1e3, 1e3);
    bytes.fill(start.qd, -1e3, 1e3);
  }
  return start;
}

/// Where a constructor accepts a huge number, the arithmetic may overflow: the case is wild, and its bounds are not
/// checked.
double any_gain(Bytes& bytes, double most, bool& wild) {
  const double gain = bytes.mostly(bytes.within(0.0, most));
  wild = wild || !(gain <= most);
  return gain;
}

fpbm::SingularDamping<> any_damping(Bytes& bytes, bool& wild) {
  if (bytes.chance(64)) return fpbm::SingularDamping<>::off();
  const double radius = bytes.mostly(bytes.within(0.0, 0.2));
  return fpbm::SingularDamping<>(radius, any_gain(bytes, 1e3, wild));
}

/// The clearance of a Panda: self-collision, and up to three shapes.
fpbm::Clearance<7> any_clearance(Bytes& bytes) {
  static const auto chain = fpbm::presets::panda();
  static const auto capsules = fpbm::presets::capsules::panda();
  static const auto never_collide = fpbm::presets::never_collide::panda();
  std::vector<fpbm::Obstacle<>> obstacles;
  const std::uint8_t which = bytes.byte();
  fpbm::Vector<3> place, direction;
  for (int kind = 0; kind < 3; ++kind) {
    if ((which >> kind & 1) == 0) continue;
    bytes.fill(place, -1.0, 1.0);
    bytes.fill(direction, -1.0, 1.0);
    const double size = bytes.spread(1e-3, 0.5);
    if (kind == 0) {
      obstacles.push_back({"wall", fpbm::HalfSpace<>{direction.normalized(), -size}});
    } else if (kind == 1) {
      obstacles.push_back({"box", fpbm::Cuboid<>{{place, fpbm::rotation(direction)}, fpbm::Vector<3>::Constant(size)}});
    } else {
      obstacles.push_back({"post", fpbm::Capsule<>{place, place + direction, 0.1 * size}});
    }
  }
  return {chain, capsules, obstacles, bytes.chance(128) ? 0.0 : bytes.spread(1e-4, 0.05), never_collide};
}

/// further: no bounds, or the clearance of the arm.
template <typename Tracker_, typename Arm, typename Space, typename Scheme, typename... Given>
void run_tracker(Bytes& bytes, const Arm& arm, Space space, const Scheme& scheme, bool wild, const Given&... further) {
  constexpr int N = Arm::kDof;
  fpbm::TrackerOptions<> options;
  options.dt = bytes.spread(1e-4, 2e-2);
  if (bytes.chance(4)) {
    options.dt = bytes.any();
    wild = true;
  }
  options.error_bound = bytes.mostly(bytes.spread(1e-3, 1.0));
  if (bytes.chance(64)) options.integral_gain = any_gain(bytes, 100.0, wild);
  options.integral_bound = bytes.mostly(bytes.spread(1e-3, 10.0));
  options.singular = any_damping(bytes, wild);
  const auto bounds = bytes.chance(64) ? arm.limits() : any_limits<N>(bytes, arm.dof(), wild);
  const auto start = any_start<N>(bytes, bounds, wild);
  const fpbm::Limits<Scheme::kLevel, N> limits(bounds, options.dt);
  Tracker_ tracker(arm, space, scheme, start, options, limits, fpbm::Vector<N>::Zero(arm.dof()), further...);
  Tracker_ twin(arm, space, scheme, start, options, limits, fpbm::Vector<N>::Zero(arm.dof()), further...);
  // From a huge tick or start, the arm cannot brake without overflow.
  if (!(options.dt > 1e-9 && options.dt < 1e9 && start.q.norm() < 1e100 && start.qd.norm() < 1e100)) return;
  const Keeper<N> keeper{limits.bounds(), options.dt};
  constexpr bool kEvenly = Scheme::kLevel == fpbm::Level::kAcceleration;

  fpbm::Vector<N> last = tracker.acceleration();
  fpbm::Vector<N> answer = last;
  const auto checked = [&](const fpbm::State<N>& before, const auto& result) {
    require_sane(result);
    require(result.q.allFinite() && result.qd.allFinite(), "positions and velocities are finite");
    require(same_bits(result.q, tracker.state().q) && same_bits(result.qd, tracker.state().qd),
            "the state is the command");
    if (!wild) keeper.require_kept(before, last, result.q, result.qd, result.qdd, kEvenly);
    last = result.qdd;
    if constexpr (Tracker_::kBounded) {
      auto clearance = tracker.bounds().template get<fpbm::Clearance<7>>();
      require(wild || clearance.nearest_pair(result.q).second >= clearance.margin() - keeper.kSlack,
              "pairs keep their margin");
    }
  };

  for (int tick = 0; tick < 100 && !bytes.empty(); ++tick) {
    const fpbm::State<N> before = tracker.state();
    const std::uint8_t what = bytes.byte();
    if (what < 8) {
      tracker.stop(), twin.stop();
    } else if (what < 16) {
      tracker.resume(), twin.resume();
    } else if (what < 64) {
      if constexpr (kEvenly) {
        fpbm::State<N> measured = before;
        fpbm::Vector<N> noise = before.q;
        bytes.fill(noise, -1e-3, 1e-3);
        measured.q += noise;
        bytes.fill(noise, -1e-2, 1e-2);
        measured.qd += noise;
        const auto reference = any_reference<Space>(bytes, tracker.tip());
        const auto result = tracker.resolve_measured(measured.q, measured.qd, reference);
        require_same(result, twin.resolve_measured(measured.q, measured.qd, reference));
        require_sane(result);
        for (Eigen::Index i = 0; !wild && i < result.qdd.size(); ++i) {
          require(std::abs(result.qdd(i)) <= keeper.bounds.acceleration(i) * (1.0 + 1e-9) + 1e-9,
                  "accelerations for a measured state keep their bounds");
          require(std::abs(result.qdd(i) - answer(i)) <= keeper.bounds.jerk(i) * options.dt * (1.0 + 1e-9) + 1e-9,
                  "accelerations for a measured state do not jump");
        }
        answer = result.qdd;
        require(same_bits(tracker.state().q, before.q), "a measured state leaves the tracker's own alone");
      }
    } else {
      const auto reference = any_reference<Space>(bytes, tracker.tip());
      const int repeated = 1 + bytes.byte() % 20;
      for (int i = 0; i < repeated; ++i) {
        const fpbm::State<N> now = tracker.state();
        const auto result = tracker.tick(reference);
        require_same(result, twin.tick(reference));
        checked(now, result);
      }
    }
  }

  // After any input, the tip can be held at its point, unless joints without bounds have become too fast.
  tracker.resume();
  const fpbm::State<N> before = tracker.state();
  wild = wild || before.qd.norm() > 1e3 || before.q.norm() > 1e6;
  const auto result = tracker.tick(fpbm::Reference<Space>::hold(tracker.tip()));
  checked(before, result);
  require(wild || result.status != fpbm::Status::kNotFinite, "a good reference gives a good tick again");
}

template <typename Arm, typename Space, typename Scheme>
void run_scheme(Bytes& bytes, const Arm& arm, Space, const Scheme& scheme) {
  constexpr int N = Arm::kDof;
  fpbm::State<N> state{fpbm::Vector<N>::Zero(arm.dof()), fpbm::Vector<N>::Zero(arm.dof())};
  bytes.fill(state.q, -4.0, 4.0);
  bytes.fill(state.qd, -3.0, 3.0);
  fpbm::Kinematics<Space, N> kinematics;
  arm.kinematics(state.q, state.qd, kinematics);
  if (bytes.chance(64)) {
    bytes.fill(kinematics.J, -1.0, 1.0);
    bytes.fill(kinematics.Jd, -1.0, 1.0);
  }
  const auto reference = any_reference<Space>(bytes, kinematics.tip);
  const fpbm::Vector<N> untouched = fpbm::Vector<N>::Constant(arm.dof(), 12345.0);
  fpbm::Vector<N> out = untouched, again = untouched;
  const fpbm::Status status = scheme.resolve(kinematics, reference, state, out);
  require(status == scheme.resolve(kinematics, reference, state, again) && same_bits(out, again),
          "resolve() is a function");
  require(failed(status) ? same_bits(out, untouched) : out.allFinite(), "resolve() gives a finite result, or none");
}

template <typename Arm, typename Space, typename Scheme>
void run(Bytes& bytes, const Arm& arm, Space space, const Scheme& scheme, bool wild) {
  if (bytes.chance(48)) {
    run_scheme(bytes, arm, space, scheme);
    return;
  }
  if constexpr (std::is_same_v<Arm, fpbm::SerialArm<7>>) {
    using Kept = fpbm::Bounds<fpbm::Clearance<7>>;
    if (bytes.chance(128)) {
      run_tracker<fpbm::Tracker<Arm, Space, Scheme, Kept>>(bytes, arm, space, scheme, wild, Kept(any_clearance(bytes)));
      return;
    }
  }
  run_tracker<fpbm::Tracker<Arm, Space, Scheme>>(bytes, arm, space, scheme, wild);
}

template <int N>
fpbm::NullSpace<N> any_null_space(Bytes& bytes, Eigen::Index dof, bool& wild) {
  fpbm::NullSpace<N> result;
  const std::uint8_t which = bytes.byte();
  if ((which & 1) != 0) result = result.with_damping(any_gain(bytes, 20.0, wild));
  if ((which & 2) != 0) {
    fpbm::Vector<N> posture = fpbm::Vector<N>::Zero(dof);
    for (Eigen::Index i = 0; i < dof; ++i) posture(i) = bytes.within(-3.0, 3.0);
    result = result.with_rest_posture(posture, any_gain(bytes, 20.0, wild));
  }
  return result;
}

template <typename Arm, typename Space>
void run_any_scheme(Bytes& bytes, const Arm& arm, Space space) {
  constexpr int N = Arm::kDof;
  bool wild = false;
  const std::uint8_t which = bytes.byte();
  const auto null_space = any_null_space<N>(bytes, arm.dof(), wild);
  const auto damping = any_damping(bytes, wild);
  fpbm::Vector<N> w = fpbm::Vector<N>::Ones(arm.dof());
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    w(i) = bytes.mostly(bytes.spread(0.1, 10.0));
    wild = wild || !(w(i) >= 0.1 && w(i) <= 10.0);
  }
  // With equal weights, WMVN is MVN and, with alpha = 0, Balanced is MAN.
  if ((which & 4) != 0) w.setOnes();
  // Drawn one by one: C++ does not say in which order a call's arguments are evaluated.
  const double alpha = (which & 8) != 0 ? 0.0 : bytes.mostly(bytes.fraction());
  const double k1 = any_gain(bytes, 100.0, wild);
  const double k2 = any_gain(bytes, 1000.0, wild);
  switch (which % 4) {
    case 0: return run(bytes, arm, space, fpbm::WMVN<N>(w, k1, null_space, damping), wild);
    case 1: return run(bytes, arm, space, fpbm::Balanced<N>(alpha, w, null_space, damping), wild);
    default: return run(bytes, arm, space, fpbm::FPBM<N>(alpha, w, k1, k2, null_space, damping), wild);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fpbm::SerialArm<7> panda(fpbm::presets::panda());
  Bytes bytes(data, size);
  try {
    switch (bytes.byte() % 3) {
      case 0: run_any_scheme(bytes, fpbm::PlanarArm<4>({1.0, 1.0, 1.0, 1.0}), fpbm::Position<2>{}); break;
      case 1: run_any_scheme(bytes, panda, fpbm::Pose{}); break;
      default: {
        const fpbm::Vector<Eigen::Dynamic> lengths = fpbm::Vector<Eigen::Dynamic>::Constant(2 + bytes.byte() % 7, 0.5);
        run_any_scheme(bytes, fpbm::make_planar_arm(lengths), fpbm::Position<2>{});
      }
    }
  } catch (const std::invalid_argument&) {  // A constructor refused its arguments.
  }
  return 0;
}
