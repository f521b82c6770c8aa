#pragma once

#include <fpbm/model/chain.hpp>
#include <string>

namespace fpbm_controllers {

/// The joints of a robot_description (URDF) from link base to link tip, with their bounds on position and velocity.
/// Throws std::invalid_argument where the text or a link is missing, link base moves with a joint that is not between
/// the links, or a joint between them is of a type that no chain has.
[[nodiscard]] fpbm::Chain<> chain_of(const std::string& robot_description, const std::string& base,
                                     const std::string& tip);

/// Throws std::invalid_argument, which names the joint and the difference, where a preset is not the described arm:
/// axes differ by more than 0.02 m or 0.05 rad from each other, or a described range or velocity exceeds the preset's
/// by more than 1 %. Bases, tips and narrower bounds may differ.
void require_match(const fpbm::Chain<>& described, const std::string& name, const fpbm::Chain<>& preset);

}  // namespace fpbm_controllers
