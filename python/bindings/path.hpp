#pragma once

#include <string>
#include <utility>
#include <variant>

#include "fpbm/task/path.hpp"

namespace fpbm::bindings {

/// Any shape of task/, chosen at construction: what Path needs of a shape, behind one type.
class AnyShape {
 public:
  using Scalar = double;
  using Space = Position<2>;

  template <typename Shape>
  explicit AnyShape(const Shape& shape) : shape_(shape) {}

  [[nodiscard]] Curve<2, double> at(double s) const noexcept;

 private:
  std::variant<Circle<double>, Lissajous<double>, Tricuspid<double>, Line<2, double>> shape_;
};

/// Any time law of task/.
struct AnyTimeLaw {
  std::variant<SinSquared, Quintic, ConstantSpeed> law;

  [[nodiscard]] Phase<double> at(double tau) const noexcept;
};

/// A path as Python sees it: Path itself, and how it was made.
struct PyPath : Path<AnyShape, AnyTimeLaw> {
  PyPath(const AnyShape& shape, double duration, const AnyTimeLaw& time_law, std::string description)
      : Path(shape, duration, time_law), repr(std::move(description)) {}

  std::string repr;
};

}  // namespace fpbm::bindings
