#include "saturate.hpp"

#include "fpbm/limits/level_saturation.hpp"

namespace fpbm::bindings {

Levels saturate(const std::vector<LevelRows>& levels, const Box<kDynamic>& box, const JointVector& rest,
                const JointVector& unit) {
  LevelSaturation<kDynamic> saturation(box, rest, unit);
  std::vector<double> scale;
  for (const auto& [J, b] : levels) scale.push_back(saturation.resolve(J, b));
  return {saturation.motion(), scale};
}

}  // namespace fpbm::bindings
