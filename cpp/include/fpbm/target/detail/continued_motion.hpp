#pragma once

#include <cmath>
#include <limits>

#include "fpbm/path/reference.hpp"
#include "fpbm/target/detail/chunk_piece.hpp"

namespace fpbm {

/// Result of continue_motion().
template <typename Space, typename Scalar>
struct ContinuedMotion {
  Reference<Space, Scalar> start;  ///< Position, velocity and acceleration at the start.
  bool all;                        ///< Whether all coordinates continue.
};

/// Start of the motion to a chunk: the present target in the coordinates that continue, and the chunk's own motion in
/// the others, which then jump. With blend > 0, all coordinates continue. With blend 0, a coordinate continues if the
/// difference is an error of the interpolation between points: in velocity, at most half of the difference between the
/// mean velocities of two successive pieces of the chunk, and in position, at most this velocity times the duration of
/// a piece. Half is a choice: with an eighth, the accelerations of smooth chunks at 5 Hz deviate by a third more.
template <typename Space, typename Scalar>
[[nodiscard]] ContinuedMotion<Space, Scalar> continue_motion(const Reference<Space, Scalar>& present,
                                                             const Reference<Space, Scalar>& own,
                                                             const ChunkPiece<Space, Scalar>& piece,
                                                             const ChunkPiece<Space, Scalar>& next,
                                                             Scalar blend) noexcept {
  ContinuedMotion<Space, Scalar> result{present, true};
  auto displacement = Space::template difference<Scalar>(present.x, own.x);
  for (Eigen::Index i = 0; i < displacement.size(); ++i) {
    // The largest differences have finite squares.
    const Scalar most = blend > Scalar(0) ? std::sqrt(std::numeric_limits<Scalar>::max())
                                          : std::abs(next.d(i) / next.h - piece.d(i) / piece.h) / Scalar(2);
    if (std::abs(displacement(i)) <= most * piece.h && std::abs(present.xd(i) - own.xd(i)) <= most) continue;
    displacement(i) = Scalar(0);
    result.start.xd(i) = own.xd(i);
    result.start.xdd(i) = own.xdd(i);
    result.all = false;
  }
  if (!result.all) result.start.x = Space::template displace<Scalar>(own.x, displacement);
  return result;
}

}  // namespace fpbm
