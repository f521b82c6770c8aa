#include "path.hpp"

namespace fpbm::bindings {

Curve<2, double> AnyShape::at(double s) const noexcept {
  return std::visit([s](const auto& shape) { return shape.at(s); }, shape_);
}

Phase<double> AnyTimeLaw::at(double tau) const noexcept {
  return std::visit([tau](const auto& chosen) { return chosen.at(tau); }, law);
}

}  // namespace fpbm::bindings
