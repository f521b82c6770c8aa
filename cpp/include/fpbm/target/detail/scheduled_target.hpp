#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/chunk_piece.hpp"
#include "fpbm/target/detail/continued_motion.hpp"
#include "fpbm/target/detail/observed_points.hpp"
#include "fpbm/target/detail/spline_velocities.hpp"
#include "fpbm/target/detail/target_bounds.hpp"

namespace fpbm {

/// Target that moves through the points of chunks (ChunkPiece). Velocities that are not given are those of a cubic
/// spline (set_spline_velocities()). An acceleration that is not given is the mean of the accelerations of the two
/// polynomials of degree 3 that meet at the point. After its last point, a target is at rest, or continues at constant
/// velocity. Times are relative to the newest stamp.
template <typename Space, typename Scalar, int Capacity>
class ScheduledTarget {
 public:
  using Point = typename Space::template Point<Scalar>;
  using Twist = Vector<Space::kRows, Scalar>;
  using Moving = Reference<Space, Scalar>;
  using Timed = TimedPoint<Space, Scalar>;
  using Piece = ChunkPiece<Space, Scalar>;

  /// Changes the time that counts as zero to a time `seconds` [s] later, and discards the pieces that end before the
  /// time `now` on the new clock.
  void shift(Scalar seconds, Scalar now) noexcept {
    for (std::size_t k = 0; k < size_; ++k) pieces_[k].from -= seconds;
    observed_.shift(seconds);
    std::size_t ended = 0;
    while (ended + 1 < size_ && pieces_[ended + 1].from <= now) ++ended;
    for (std::size_t k = ended; k < size_; ++k) pieces_[k - ended] = pieces_[k];
    size_ -= ended;
  }

  /// The target rests at x until the first point of a chunk.
  void hold(const Point& x) noexcept {
    pieces_[0] = Piece::last(std::numeric_limits<Scalar>::lowest(), Moving::hold(x));
    size_ = 1;
    observed_.clear();
  }

  /// Replaces the points from the first of `count` points on, whose times increase. After the last point, the target is
  /// at rest, or continues at constant velocity. usable: changes a point to a point that the target may pass. Returns
  /// false without an effect if there is not enough memory.
  template <typename Usable>
  [[nodiscard]] bool replace(const Timed* points, int count, const Usable& usable, bool continues) noexcept {
    const std::size_t first = before(points[0].time);
    const std::size_t end = first + static_cast<std::size_t>(count);
    if (end > pieces_.size()) return false;
    const Twist none = zero();
    for (std::size_t k = first; k < end; ++k) {
      pieces_[k] = Piece::last(points[k - first].time, Moving::hold(usable(points[k - first].x)));
      if (k == first) continue;
      pieces_[k - 1].lead_to(pieces_[k]);
      pieces_[k - 1].joined = k + 1 < end;
    }
    if (first > 0) pieces_[first - 1].joined = false;
    size_ = end;
    set_spline_velocities<Capacity>(pieces_.data() + first, static_cast<std::size_t>(count));
    for (std::size_t k = first; k < end; ++k) {
      const auto& given = points[k - first].xd;
      if (given) pieces_[k].start.xd = *given;
      if (k > first) pieces_[k - 1].set_end(pieces_[k].start.xd, none);
    }
    for (std::size_t k = first; k < end; ++k) {
      const auto& given = points[k - first].xdd;
      pieces_[k].start.xdd = given ? *given : acceleration_at(k, first);
      if (k > first) pieces_[k - 1].set_end(pieces_[k].start.xd, pieces_[k].start.xdd);
    }
    Moving& rest = pieces_[end - 1].start;
    last_ = rest;
    if (!continues) rest.xd = none;
    rest.xdd = none;
    set_ranges();
    return true;
  }

  /// Replaces points as replace(), and continues the present motion of the target (continue_motion()) from the time
  /// `now`, or from the first point if this point is later: a polynomial leads to a point of the chunk. The polynomial
  /// takes at least `blend` [s], and at least the time between two points.
  template <typename Usable>
  [[nodiscard]] bool continue_with(const Timed* points, int count, const Usable& usable, Scalar now,
                                   Scalar blend) noexcept {
    const Scalar begin = std::max(now, points[0].time);
    const Moving present = at(active(begin), begin);
    const std::size_t from = begin > now ? before(begin) : 0;  // The pieces before are over.
    if (!replace(points, count, usable, false)) return false;
    observed_.clear();
    const std::size_t k = active(begin);
    const Piece piece = pieces_[k];
    if (!piece.joined && !(blend > Scalar(0) && piece.h > Scalar(0))) return true;
    const Moving own = piece.at(begin - piece.from);
    const auto [start, all] = continue_motion<Space>(present, own, piece, pieces_[k + 1], blend);
    std::size_t to = k + 1;
    while (to + 1 < size_ && pieces_[to].from < begin + std::max(blend, piece.h)) ++to;
    pieces_[from] = Piece::last(begin, start);
    pieces_[from].joined = true;
    pieces_[from].lead_to(pieces_[to]);
    pieces_[from].set_end(pieces_[to].start.xd, pieces_[to].start.xdd);
    if (from > 0) pieces_[from - 1].joined = all;
    for (std::size_t j = to; j < size_; ++j) pieces_[from + 1 + j - to] = pieces_[j];
    size_ -= to - from - 1;
    set_ranges();
    return true;
  }

  /// Adds a point, after which the target continues. now: the present time. A polynomial leads from the point before to
  /// the point, with the rates of ObservedPoints, or if the point before has passed, from the present target to the
  /// prediction for two periods later (with one period, the accelerations are twice as large).
  [[nodiscard]] bool extend(Scalar time, const Point& x, Scalar now) noexcept {
    const auto same = [](const Point& point) noexcept { return point; };
    if (!(time > observed_.time())) observed_.clear();
    const bool first = observed_.empty();
    const bool waits = !first && end().from == observed_.time() && end().from >= now;
    const Moving start = waits ? Moving{end().start.x, last_.xd, last_.xdd} : at(active(now), now);
    observed_.add(time, x);
    const auto [xd, xdd] = observed_.rates(!waits);
    const Scalar ahead = waits ? Scalar(0) : std::max(now + Scalar(2) * observed_.period() - time, Scalar(0));
    const Timed points[2] = {{waits ? end().from : now, start.x, start.xd, start.xdd},
                             {time + ahead, Space::template displace<Scalar>(x, ahead * (xd + ahead / Scalar(2) * xdd)),
                              Twist(xd + ahead * xdd), xdd}};
    return first ? replace(points + 1, 1, same, true) : replace(points, 2, same, true);
  }

  /// Index of the piece at a time.
  [[nodiscard]] std::size_t active(Scalar time) const noexcept {
    std::size_t k = 0;
    while (k + 1 < size_ && pieces_[k + 1].from <= time) ++k;
    return k;
  }

  /// The target at a time [s] at which, or shortly before which, piece k is active. If the points of another chunk
  /// follow on the piece, the target continues along the piece.
  [[nodiscard]] Moving at(std::size_t k, Scalar time) const noexcept {
    while (pieces_[k].joined && pieces_[k + 1].from <= time) ++k;
    return pieces_[k].at(time - pieces_[k].from);
  }
  /// Bound on the magnitude of the jerk of coordinate i until a time at which, or shortly before which, piece k is
  /// active.
  [[nodiscard]] Scalar largest_jerk(std::size_t k, Scalar time, Eigen::Index i) const noexcept {
    Scalar jerk(0);
    for (;; ++k) {
      jerk = std::max(jerk, pieces_[k].largest_jerk(i, time - pieces_[k].from));
      if (!pieces_[k].joined || pieces_[k + 1].from > time) break;
    }
    return jerk;
  }

  /// Whether the target continues after its last point, and the time of this point [s].
  [[nodiscard]] bool continues() const noexcept { return !observed_.empty(); }
  [[nodiscard]] Scalar end_time() const noexcept { return observed_.time(); }

  /// Range of coordinate i of the target `now`, at which a piece is active, and of the points after this time.
  [[nodiscard]] Range<Scalar> range_after(std::size_t active_piece, const Point& now, Eigen::Index i) const noexcept {
    Range<Scalar> range{coordinate(now, i), coordinate(now, i)};
    const Piece& piece = pieces_[active_piece];
    // The part of the present piece that has passed must not extend the range.
    if (piece.h > Scalar(0) && piece.start.xd(i) * piece.end.xd(i) < Scalar(0)) piece.include_extremes(i, range);
    if (active_piece + 1 < size_) {
      range.include(pieces_[active_piece + 1].low(i));
      range.include(pieces_[active_piece + 1].high(i));
    }
    return range;
  }

 private:
  [[nodiscard]] static Twist zero() noexcept { return filled<Twist>(Space::kRows); }
  [[nodiscard]] const Piece& end() const noexcept { return pieces_[size_ - 1]; }

  void set_ranges() noexcept {
    for (std::size_t k = size_; k-- > 0;) pieces_[k].set_range(k + 1 < size_ ? &pieces_[k + 1] : nullptr);
  }
  /// Number of pieces that begin before a time.
  [[nodiscard]] std::size_t before(Scalar time) const noexcept {
    std::size_t k = 0;
    while (k < size_ && pieces_[k].from < time) ++k;
    return k;
  }
  /// Acceleration at the start of piece k, from the pieces of a chunk from `first` on.
  [[nodiscard]] Twist acceleration_at(std::size_t k, std::size_t first) const noexcept {
    const bool ends = k + 1 == size_;
    if (k == first) return ends ? zero() : pieces_[k].first();
    if (ends) return pieces_[k - 1].last();
    return (pieces_[k - 1].last() + pieces_[k].first()) / Scalar(2);
  }

  std::array<Piece, static_cast<std::size_t>(Capacity)> pieces_;
  std::size_t size_ = 0;
  Moving last_;  ///< Velocity and acceleration at the last point, before the target rests or continues.
  ObservedPoints<Space, Scalar> observed_;
};

}  // namespace fpbm
