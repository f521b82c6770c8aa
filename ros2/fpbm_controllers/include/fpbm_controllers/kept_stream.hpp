#pragma once

#include <algorithm>
#include <fpbm/core/types.hpp>
#include <fpbm/target/stream.hpp>
#include <fpbm_controllers/joint_chunk.hpp>
#include <stdexcept>
#include <string>

namespace fpbm_controllers {

/// A stream of postures whose clock slows down while the arm does not follow, so that the reference waits for the arm
/// on the path of a chunk. A message ends the wait until the arm follows again: no wait can prevent the motion to a new
/// chunk.
class KeptStream {
 public:
  using Stream = fpbm::JointStream<fpbm::kMaxDof, double, JointChunk::kPoints>;
  using Moving = fpbm::Reference<fpbm::JointSpace<fpbm::kMaxDof>, double>;

  /// tolerance: error of a joint at which the clock stops [rad]; 0: the clock never waits. Throws std::invalid_argument
  /// if the joints can move by the tolerance within two ticks: then the rate of the clock would oscillate.
  KeptStream(const fpbm::JointLimits<Eigen::Dynamic>& limits, const fpbm::StreamOptions<>& options, double tolerance)
      : stream_(stream_within<JointChunk::kPoints>(limits, options)), tolerance_(tolerance) {
    const double least = 2.0 * limits.velocity.maxCoeff() * options.dt;
    if (tolerance == 0.0 || tolerance >= least) return;
    throw std::invalid_argument("stream.keep_path: is " + std::to_string(tolerance) + ": must be 0 or at least " +
                                std::to_string(least) + ", two ticks at the largest velocity of the joints");
  }

  [[nodiscard]] Moving ahead(double seconds) const noexcept {
    const double t = clock_.phase + clock_.rate * seconds;
    const double dt = stream_.dt();
    Moving moving = t <= dt ? stream_.ahead(t) : fpbm::ahead(stream_.ahead(dt), t - dt);
    moving.xd *= clock_.rate;
    moving.xdd *= clock_.rate * clock_.rate;
    return moving;
  }

  /// Advances by one tick. error: largest error of a joint at the start of the tick.
  void advance(double error) noexcept {
    const double dt = stream_.dt();
    clock_.phase += clock_.rate * dt;
    clock_.late += dt;
    if (clock_.phase >= (1.0 - kRoundOff) * dt) {
      clock_.phase = std::max(clock_.phase - dt, 0.0);
      clock_.late -= dt;
      stream_.advance();
    }
    const double follows = kFollows * tolerance_;
    clock_.keeps = tolerance_ > 0.0 && (clock_.keeps || (clock_.is_path && error <= follows));
    const double wanted = clock_.keeps ? std::max(0.0, (tolerance_ - error) / (tolerance_ - follows)) : 1.0;
    clock_.rate = std::min(wanted, 1.0 - std::min(clock_.phase / dt, kReturn));
  }

  /// Returns false if the chunk is rejected because of its stamp.
  bool push(JointChunk& chunk) noexcept {
    clock_.keeps = false;
    clock_.is_path = !chunk.single;
    if (chunk.starts) chunk.points[0] = {0.0, stream_.reference().x, stream_.reference().xd, stream_.reference().xdd};
    const auto push = [&](auto... stamp) noexcept {
      return chunk.single ? stream_.push(chunk.points[0].x, stamp...)
                          : stream_.push_chunk(chunk.points.data(), static_cast<int>(chunk.points.size()), stamp...);
    };
    const bool accepted = chunk.stamp == 0.0 ? push() : push(chunk.stamp - clock_.late);
    if (accepted) clock_.late_before = clock_.late;
    return accepted;
  }

  void set_speed(double fraction) noexcept { (void)stream_.set_speed(fraction); }

  /// Restarts at rest at q.
  void reset(const fpbm::Vector<fpbm::kMaxDof>& q) noexcept {
    (void)stream_.reset(q);
    clock_ = {};
  }

  /// Time since the newest stamp [s].
  [[nodiscard]] double age() const noexcept { return stream_.age() + clock_.late - clock_.late_before; }

 private:
  /// Error up to which the clock keeps its rate, relative to the tolerance: a choice. The error of an arm that follows
  /// within its limits is at most 0.03 mrad (docs/streams.md).
  static constexpr double kFollows = 0.1;
  /// Part of the rate by which the phase returns to 0 after a wait: a choice.
  static constexpr double kReturn = 0.01;
  static constexpr double kRoundOff = 1e-9;

  struct Clock {
    double rate = 1.0;         ///< Rate of the clock of the stream.
    double phase = 0.0;        ///< Time since the start of the stream's tick [s].
    double late = 0.0;         ///< Time by which the start of the stream's tick is late [s].
    double late_before = 0.0;  ///< `late` at the newest message [s].
    bool is_path = false;      ///< Whether the newest message is a chunk.
    bool keeps = false;        ///< Whether the arm has followed the newest chunk.
  };

  Stream stream_;
  double tolerance_;
  Clock clock_;
};

}  // namespace fpbm_controllers
