#include "path.hpp"

#include <stdexcept>
#include <type_traits>

#include "fpbm/task/in_plane.hpp"
#include "fpbm/task/with_rotation.hpp"

namespace fpbm::bindings {
namespace {

template <typename To, typename From>
AnyPath<To> convert(const AnyPath<From>& path) {
  constexpr bool kFlat = std::is_same_v<To, Position<2>> || std::is_same_v<To, PlanarPose>;
  if constexpr (std::is_same_v<To, From>) {
    return path;
  } else if constexpr (std::is_same_v<From, PlanarPose> || std::is_same_v<From, Pose>) {
    throw std::invalid_argument(std::string("path: it turns the tip, which needs ") +
                                (kFlat == std::is_same_v<From, PlanarPose> ? "task='pose'" : "another kind of arm"));
  } else if constexpr (kFlat && std::is_same_v<From, Position<3>>) {
    throw std::invalid_argument("path: it lies in space, and the arm in a plane");
  } else if constexpr (std::is_same_v<To, Position<3>>) {
    return AnyPath<To>(InPlane(path, Vector<3>::UnitX(), Vector<3>::UnitY()));
  } else if constexpr (std::is_same_v<typename PoseOver<From>::type, To>) {
    return AnyPath<To>(WithRotation(path));
  } else {
    return convert<To>(convert<Position<3>>(path));
  }
}

}  // namespace

template <typename Space>
AnyPath<Space> PyPath::as() const {
  return std::visit([](const auto& any) { return convert<Space>(any); }, path);
}

template AnyPath<Position<2>> PyPath::as() const;
template AnyPath<PlanarPose> PyPath::as() const;
template AnyPath<Position<3>> PyPath::as() const;
template AnyPath<Pose> PyPath::as() const;

}  // namespace fpbm::bindings
