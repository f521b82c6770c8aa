// A policy sends chunks of joint postures, late and with jumps, to an SO-101 and to a Panda.
//
// Each chunk has 16 postures at 15 Hz, from the time of the observation. The inference takes 0.1 to 0.3 s, and once
// 1 s. A new chunk continues elsewhere by 20 to 70 mrad, because the policy decodes each chunk from another state. One
// chunk is not finite, one arrives twice, and two arrive in the wrong order. A forwarder interpolates the newest chunk
// linearly. A JointStream keeps the bounds.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fpbm/fpbm.hpp>
#include <limits>
#include <string>
#include <vector>

namespace {

constexpr double kPeriod = 1.0 / 15.0;  // [s]
constexpr int kHorizon = 16;            // Postures of a chunk.
constexpr int kExecuted = 8;            // Postures until the next observation.
constexpr double kSeconds = 10.0;

template <int N>
struct Chunk {
  double comes;  // [s]
  double stamp;  // Time of the observation, and of the first posture [s].
  std::vector<fpbm::Vector<N>> postures;
};

/// Chunks in the order of their arrival.
template <int N>
std::vector<Chunk<N>> policy(const fpbm::Vector<N>& home) {
  std::vector<Chunk<N>> chunks;
  for (int number = 0; number < static_cast<int>(std::lround(kSeconds / (kExecuted * kPeriod))); ++number) {
    const double stamp = number * kExecuted * kPeriod;
    Chunk<N> chunk{stamp + (number == 9 ? 1.0 : 0.2 + 0.1 * std::sin(5.0 * number)), stamp, {}};
    for (int k = 0; k < kHorizon; ++k) {
      const double swing = 0.3 * std::pow(std::sin(1.2 * (stamp + k * kPeriod)), 2);
      fpbm::Vector<N> q = home;
      for (int joint = 0; joint < N; ++joint) {
        const double jump = 0.045 + 0.025 * std::sin(3.0 * number + joint);
        q[joint] += swing * std::cos(joint) + ((number + joint) % 2 == 0 ? jump : -jump);
      }
      chunk.postures.push_back(q);
    }
    chunks.push_back(chunk);
  }
  chunks[4].postures[3][1] = std::numeric_limits<double>::quiet_NaN();
  chunks.push_back(chunks[12]);
  std::stable_sort(chunks.begin(), chunks.end(), [](const auto& a, const auto& b) { return a.comes < b.comes; });
  return chunks;
}

/// The newest finite chunk, interpolated linearly.
template <int N>
class Forwarder {
 public:
  explicit Forwarder(const fpbm::Vector<N>& home) : newest_{0.0, 0.0, {home}} {}

  bool receive(const Chunk<N>& chunk) {
    const bool finite =
        std::all_of(chunk.postures.begin(), chunk.postures.end(), [](const auto& q) { return q.allFinite(); });
    if (finite) newest_ = chunk;
    return finite;
  }

  fpbm::Vector<N> command(double now) const {
    const auto last = static_cast<double>(newest_.postures.size() - 1);
    const double at = std::clamp((now - newest_.stamp) / kPeriod, 0.0, last);
    const auto before = static_cast<std::size_t>(at);
    const std::size_t after = std::min(before + 1, newest_.postures.size() - 1);
    const fpbm::Vector<N>& q = newest_.postures[before];
    return q + (at - std::floor(at)) * (newest_.postures[after] - q);
  }

 private:
  Chunk<N> newest_;
};

/// A JointStream of an arm.
template <int N>
class Shield {
 public:
  Shield(const fpbm::Vector<N>& home, const fpbm::JointLimits<N>& limits, double dt)
      : stream_(home, limits, options(dt)) {}

  bool receive(const Chunk<N>& chunk) {
    std::array<fpbm::TimedPoint<fpbm::JointSpace<N>>, kHorizon> points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k].time = static_cast<double>(k) * kPeriod;
      points[k].x = chunk.postures[k];
    }
    return stream_.push_chunk(points.data(), kHorizon, chunk.stamp);
  }

  fpbm::Vector<N> command(double /*now*/) {
    stream_.advance();
    return stream_.reference().x;
  }

 private:
  static fpbm::StreamOptions<> options(double dt) {
    fpbm::StreamOptions<> given;
    given.dt = dt;
    given.start = 0.0;
    return given;
  }

  fpbm::JointStream<N> stream_;
};

/// Moves an arm, and prints its largest velocity, acceleration and jerk relative to the bounds. Returns the largest.
template <int N, typename Loop>
double move(const char* name, Loop loop, const fpbm::Vector<N>& home, const fpbm::JointLimits<N>& limits, double dt) {
  const std::vector<Chunk<N>> chunks = policy<N>(home);
  std::array<fpbm::Vector<N>, 4> q{home, home, home, home};  // The last four commands.
  std::array<double, 3> shares{};
  std::size_t next = 0;
  int taken = 0;
  for (int tick = 1; tick < static_cast<int>(std::lround(kSeconds / dt)); ++tick) {
    for (; next < chunks.size() && chunks[next].comes <= tick * dt; ++next) taken += loop.receive(chunks[next]) ? 1 : 0;
    std::rotate(q.begin(), q.begin() + 1, q.end());
    q[3] = loop.command(tick * dt);
    const auto raise = [](double& share, const fpbm::Vector<N>& rate, const fpbm::Vector<N>& bound) {
      share = std::max(share, rate.cwiseAbs().cwiseQuotient(bound).maxCoeff());
    };
    raise(shares[0], (q[3] - q[2]) / dt, limits.velocity);
    raise(shares[1], (q[3] - 2.0 * q[2] + q[1]) / (dt * dt), limits.acceleration);
    raise(shares[2], (q[3] - 3.0 * (q[2] - q[1]) - q[0]) / (dt * dt * dt), limits.jerk);
  }
  std::printf("%s: %d of %zu chunks; velocity, acceleration, jerk / bound: %.3g, %.3g, %.3g\n", name, taken,
              chunks.size(), shares[0], shares[1], shares[2]);
  return *std::max_element(shares.begin(), shares.end());
}

/// Whether the JointStream keeps the bounds, and the forwarder does not.
template <int N>
bool compare(const char* name, const fpbm::Chain<>& chain, const fpbm::Vector<N>& home, double dt) {
  fpbm::JointLimits<N> limits = fpbm::SerialArm<N>(chain).limits();
  if (!limits.jerk.allFinite()) limits.jerk = 20.0 * limits.acceleration;
  const std::string arm = name;
  const double forwarded = move<N>((arm + ", forwarder").c_str(), Forwarder<N>(home), home, limits, dt);
  const double shielded = move<N>((arm + ", JointStream").c_str(), Shield<N>(home, limits, dt), home, limits, dt);
  return forwarded > 1.0 && shielded <= 1.0 + 1e-8;  // Third differences of rounded postures.
}

}  // namespace

int main() {
  const fpbm::Vector<5> so101{0.0, -0.35, 0.7, 1.2, 0.0};  // [rad]
  const fpbm::Vector<7> panda{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};
  const bool kept = compare<5>("so101", fpbm::presets::so101(), so101, 0.01);
  return compare<7>("panda", fpbm::presets::panda(), panda, 0.001) && kept ? 0 : 1;
}
