#pragma once

#include <memory>

#include "fpbm/path/detail/kept_motion.hpp"
#include "fpbm/path/path.hpp"
#include "fpbm/path/reference.hpp"

namespace fpbm {

/// One type for all paths in a task space. AnyPath is a path, and each sample is one virtual call. Copies share the
/// stored path.
template <typename Space_>
class AnyPath {
 public:
  using Scalar = double;
  using Space = Space_;

  template <typename Path>
  explicit AnyPath(const Path& path) : held_(std::make_shared<const Held<Path>>(path)), duration_(path.duration()) {}

  [[nodiscard]] double duration() const noexcept { return duration_; }
  /// The motion along a kept path (TimedPath), or null.
  [[nodiscard]] const KeptMotion* motion() const noexcept { return held_->motion(); }
  [[nodiscard]] Reference<Space> sample(double t) const noexcept { return held_->sample(t, t); }
  [[nodiscard]] Reference<Space> sample(double t, double since) const noexcept { return held_->sample(t, since); }

 private:
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    [[nodiscard]] virtual const KeptMotion* motion() const noexcept = 0;
    [[nodiscard]] virtual Reference<Space> sample(double t, double since) const noexcept = 0;
  };

  template <typename Path>
  struct Held final : Holder {
    explicit Held(const Path& path_) : path(path_) {}
    [[nodiscard]] const KeptMotion* motion() const noexcept override { return motion_along(path); }
    [[nodiscard]] Reference<Space> sample(double t, double since) const noexcept override {
      return sample_within(path, t, since);
    }
    Path path;
  };

  std::shared_ptr<const Holder> held_;
  double duration_;
};

}  // namespace fpbm
