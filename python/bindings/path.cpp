#include "path.hpp"

#include "fpbm/any/convert_path.hpp"

namespace fpbm::bindings {

template <typename Space>
AnyPath<Space> Path::as() const {
  return std::visit([](const auto& path) { return convert_path<Space>(path); }, any);
}

template AnyPath<Position<2>> Path::as() const;
template AnyPath<PlanarPose> Path::as() const;
template AnyPath<Position<3>> Path::as() const;
template AnyPath<Pose> Path::as() const;

}  // namespace fpbm::bindings
