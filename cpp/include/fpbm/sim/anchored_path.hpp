#pragma once

#include "fpbm/task/path.hpp"
#include "fpbm/task/reference.hpp"

namespace fpbm {

/// A path laid out from where the tip starts, in two segments: the motion, then a hold at rest on its end.
///
/// A reference may jump where they meet (the paper's xdd does), so each step of an integrator asks its own segment.
/// Remembers the last sample, since RK4 asks for each mid-point twice and for each end again as the next start.
template <typename Path>
class AnchoredPath {
 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;
  using Point = typename Space::template Point<Scalar>;

  AnchoredPath(const Path& path, const Point& anchor) noexcept
      : path_(path), anchor_(anchor), end_(anchor), time_(0), since_(0), last_(from_anchor(Scalar(0), Scalar(0))) {
    end_ = from_anchor(path.duration(), path.duration()).x;
  }

  /// Reference at t [s] of the motion, in an integrator's step that starts at since; the motion's last instant is T
  /// however t is rounded.
  [[nodiscard]] const Reference<Space, Scalar>& motion(Scalar t, [[maybe_unused]] Scalar since) noexcept {
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
  [[nodiscard]] Reference<Space, Scalar> from_anchor(Scalar t, Scalar since) const noexcept {
    Reference<Space, Scalar> reference = sample_within(path_, t, since);
    reference.x = Space::template compose<Scalar>(anchor_, reference.x);
    return reference;
  }

  const Path& path_;
  Point anchor_;
  Point end_;
  Scalar time_;
  Scalar since_;
  Reference<Space, Scalar> last_;
};

}  // namespace fpbm
