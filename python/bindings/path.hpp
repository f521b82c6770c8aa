#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>

#include "fpbm/core/space.hpp"
#include "fpbm/task/path.hpp"

namespace fpbm::bindings {

/// Any path of a task space, behind one type.
template <typename Space_>
class AnyPath {
 public:
  using Scalar = double;
  using Space = Space_;

  template <typename Path>
  explicit AnyPath(const Path& path) : held_(std::make_shared<Held<Path>>(path)), duration_(path.duration()) {}

  [[nodiscard]] double duration() const noexcept { return duration_; }
  [[nodiscard]] Reference<Space> sample(double t) const noexcept { return held_->sample(t, t); }
  [[nodiscard]] Reference<Space> sample(double t, double since) const noexcept { return held_->sample(t, since); }

 private:
  struct Holder {
    Holder() = default;
    Holder(const Holder&) = delete;
    Holder& operator=(const Holder&) = delete;
    virtual ~Holder() = default;
    [[nodiscard]] virtual Reference<Space> sample(double t, double since) const noexcept = 0;
  };

  template <typename Path>
  struct Held final : Holder {
    explicit Held(const Path& path_) : path(path_) {}
    [[nodiscard]] Reference<Space> sample(double t, double since) const noexcept override {
      return sample_within(path, t, since);
    }
    Path path;
  };

  std::shared_ptr<const Holder> held_;
  double duration_;
};

struct Recipe;

/// A path as Python sees it, in the task space that it was made in, and how it was made.
struct PyPath {
  std::variant<AnyPath<Position<2>>, AnyPath<PlanarPose>, AnyPath<Position<3>>, AnyPath<Pose>> path;
  std::string repr;
  std::shared_ptr<const Recipe> recipe;

  [[nodiscard]] double duration() const {
    return std::visit([](const auto& any) { return any.duration(); }, path);
  }

  /// The path for a task in that space: a path of the plane lies in space's xy plane, and a path of positions holds the
  /// tip's orientation. Throws std::invalid_argument where the task cannot follow it.
  template <typename Space>
  [[nodiscard]] AnyPath<Space> as() const;
};

}  // namespace fpbm::bindings
