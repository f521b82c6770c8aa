#pragma once

#include "fpbm/path/path.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// Path in the base frame from the start position of the tip, in two segments: the motion, then rest at the end of the
/// path.
///
/// The reference may be discontinuous between the segments (for example xdd of SinSquared). Therefore, each step of an
/// integrator reads the reference of its own segment. RK4 reads the reference in the middle of a step twice, and the
/// reference at the end of a step again at the start of the next step. Therefore, the last reference is stored.
/// With lanes, many arms follow one path, each from its own tip.
template <typename Path, typename Scalar = typename Path::Scalar>
class AnchoredPath {
 public:
  using Time = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  /// path must outlive the AnchoredPath.
  AnchoredPath(const Path& path, const Point& anchor) noexcept
      : path_(path), anchor_(anchor), end_(anchor), time_(0), since_(0), last_(from_anchor(Time(0), Time(0))) {
    end_ = from_anchor(path.duration(), path.duration()).x;
  }
  AnchoredPath(const Path&& path, const Point& anchor) = delete;

  /// Reference at t [s] of the motion, in a step of an integrator that starts at `since`. If t exceeds the duration by
  /// round-off, t is limited to the duration.
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

  /// Reference after the motion, at rest at the end of the path.
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
