#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "fpbm/model/chain.hpp"

namespace fpbm {

/// Names of the joints that have a drive, for messages, without heap allocation: a name is cut to 31 bytes, between
/// characters of UTF-8. A joint without a name has an index.
template <int N>
class DriveNames {
 public:
  /// source: a Chain or a Tree.
  template <typename Source>
  explicit DriveNames(const Source& source) {
    std::size_t drive = 0;
    for (std::size_t i = 0; i < source.joints.size(); ++i) {
      const auto& joint = joint_of(source, static_cast<Eigen::Index>(i));
      if (joint.mimic.joint >= 0 || drive == names_.size()) continue;
      const std::string_view name = joint.name;
      auto& text = names_[drive++];
      std::size_t size = std::min(name.size(), text.size() - 1);
      while (size > 0 && size < name.size() && (name[size] & 0xC0) == 0x80) --size;
      name.copy(text.data(), size);
    }
  }

  /// "joint 'name'" or "joints[i]".
  [[nodiscard]] validation::Argument operator[](Eigen::Index i) const {
    const char* const name = names_[static_cast<std::size_t>(i)].data();
    if (name[0] == '\0') return validation::element("joints", i);
    return validation::Argument("joint '") + std::string_view(name) + "'";
  }

 private:
  std::array<std::array<char, 32>, static_cast<std::size_t>(kCapacity<N>)> names_{};
};

}  // namespace fpbm
