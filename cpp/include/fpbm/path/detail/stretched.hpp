#pragma once

#include "fpbm/path/path.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// A path whose duration is multiplied by a factor.
template <typename Path>
class Stretched {
 public:
  using Scalar = typename Path::Scalar;
  using Space = typename Path::Space;

  Stretched(const Path& path, Scalar factor) : path_(path), factor_(factor) {}

  [[nodiscard]] Scalar duration() const noexcept { return factor_ * path_.duration(); }

  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t) const noexcept { return sample(t, t); }
  [[nodiscard]] Reference<Space, Scalar> sample(Scalar t, Scalar since) const noexcept {
    Reference<Space, Scalar> reference = sample_within(path_, t / factor_, since / factor_);
    reference.xd = reference.xd / factor_;
    reference.xdd = reference.xdd / (factor_ * factor_);
    return reference;
  }

 private:
  Path path_;
  Scalar factor_;
};

}  // namespace fpbm
