#include "support/paper.hpp"

namespace fpbm::test {

PlanarArm<4> paper_arm() {
  return PlanarArm<4>(Vector<4>::Ones());
}

State<4> paper_start() {
  return {{kPi / 12, kPi / 12, kPi / 15, kPi / 15}, Vector<4>::Zero()};
}

AnyPath<Position<2>> paper_circle() {
  return AnyPath<Position<2>>(Path(Circle(0.45), kDuration));
}
AnyPath<Position<2>> paper_lissajous() {
  return AnyPath<Position<2>>(Path(Lissajous<>({0.4, 0.4}, {2, 1}, kPi / 6), kDuration));
}
AnyPath<Position<2>> paper_tricuspid() {
  return AnyPath<Position<2>>(Path(Tricuspid(0.3), kDuration));
}

DiagonalWeights<4> paper_weights() {
  return DiagonalWeights<4>(Vector<4>(1, 2, 3, 4));
}

AccelerationScheme<4> paper_fpbm(const NullSpace<4>& null_space) {
  return FPBM<4>(0.6, paper_weights(), 1.0, 1.0, null_space);
}

AnyPath<Position<2>> paper_path(Figure figure) {
  if (figure == Figure::kLissajous) return paper_lissajous();
  return figure == Figure::kCircle ? paper_circle() : paper_tricuspid();
}

}  // namespace fpbm::test
