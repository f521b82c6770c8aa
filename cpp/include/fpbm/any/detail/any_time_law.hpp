#pragma once

#include <cstddef>
#include <iterator>
#include <string>

#include "fpbm/core/detail/validation.hpp"
#include "fpbm/path/path.hpp"

namespace fpbm {

/// One type for all time laws, by name. For programs that read the time law at run time.
class AnyTimeLaw {
 public:
  static constexpr const char* kNames[] = {"sin_squared", "quintic", "constant_speed"};

  /// Throws ParameterError if no time law has this name.
  explicit AnyTimeLaw(const std::string& name) {
    while (law_ < std::size(kNames) && name != kNames[law_]) ++law_;
    if (law_ == std::size(kNames)) {
      validation::reject("time_law", " = '" + name + "': must be 'sin_squared', 'quintic' or 'constant_speed'");
    }
  }

  template <typename Scalar>
  [[nodiscard]] Phase<Scalar> at(Scalar tau) const noexcept {
    if (law_ == 0) return SinSquared::at(tau);
    return law_ == 1 ? Quintic::at(tau) : ConstantSpeed::at(tau);
  }

 private:
  std::size_t law_ = 0;
};

}  // namespace fpbm
