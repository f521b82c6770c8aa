#pragma once

#include "fpbm/task/path.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// A path in the base frame, from where the tip starts, in two segments: the motion, then a hold at rest on its end.
///
/// The reference may jump between them (the paper's xdd does), so each step of an integrator asks its own segment.
/// Remembers the last sample, since RK4 asks for each mid-point twice, and for each end again as the next start.
/// In lanes, many arms follow one path, each from its own tip.
template <typename Path, typename Scalar = typename Path::Scalar>
class AnchoredPath {
 public:
  using Time = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// path must outlive it.
  AnchoredPath(const Path& path, const Point& anchor) noexcept
      : path_(path), anchor_(anchor), end_(anchor), time_(0), since_(0), last_(from_anchor(Time(0), Time(0))) {
    end_ = from_anchor(path.duration(), path.duration()).x;
  }
  AnchoredPath(const Path&& path, const Point& anchor) = delete;

  /// Reference at t [s] of the motion, in an integrator's step that starts at since; t is clipped to T, which round-off
  /// may exceed.
  [[nodiscard]] const Reference<Space, Scalar>& motion(Time t, [[maybe_unused]] Time since) noexcept {
    bool known = t == time_;
    if constexpr (kHasPieces<Path>) known = known && since == since_;
    if (!known) {
      time_ = t;
      since_ = since;
      last_ = from_anchor(t < path_.duration() ? t : path_.duration(), since);
    }
    return last_;
  }

  /// Reference during the hold.
  [[nodiscard]] Reference<Space, Scalar> hold() const noexcept { return Reference<Space, Scalar>::hold(end_); }

 private:
  [[nodiscard]] Reference<Space, Scalar> from_anchor(Time t, Time since) const noexcept {
    Reference<Space, Scalar> reference = sample_within(path_, t, since).template cast<Scalar>();
    reference.x = Space::template compose<Scalar>(anchor_, reference.x);
    return reference;
  }

  const Path& path_;
  Point anchor_;
  Point end_;
  Time time_;
  Time since_;
  Reference<Space, Scalar> last_;
};

}  // namespace fpbm
