#include "kinematics.hpp"

namespace fpbm::bindings {

template <typename Space>
Status resolve(const PyScheme& scheme, const Kinematics<Space, kDynamic>& kinematics, const Reference<Space>& reference,
               const State<kDynamic>& state, Joints& out) {
  return scheme.visit<kDynamic>(static_cast<int>(state.q.size()),
                                [&](const auto& chosen) { return chosen.resolve(kinematics, reference, state, out); });
}

template Status resolve(const PyScheme&, const Kinematics<Position<2>, kDynamic>&, const Reference<Position<2>>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const Kinematics<PlanarPose, kDynamic>&, const Reference<PlanarPose>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const Kinematics<Position<3>, kDynamic>&, const Reference<Position<3>>&,
                        const State<kDynamic>&, Joints&);
template Status resolve(const PyScheme&, const Kinematics<Pose, kDynamic>&, const Reference<Pose>&,
                        const State<kDynamic>&, Joints&);

}  // namespace fpbm::bindings
