#pragma once

#include <array>
#include <cmath>
#include <fpbm/model/joint.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fpbm_controllers {

/// Limits of joints, each the narrowest of several sources, and the name of that source.
class SourcedLimits {
 public:
  using JointLimits = fpbm::JointLimits<Eigen::Dynamic>;

  SourcedLimits(const JointLimits& limits, const char* source)
      : limits_(limits.complete()), sources_(static_cast<std::size_t>(limits.lower.size())) {
    for (auto& joint : sources_) joint.fill(source);
  }

  [[nodiscard]] const JointLimits& limits() const noexcept { return limits_; }

  /// Applies the given bounds that are narrower, and bounds on velocity near the ends of ranges.
  void narrow(const JointLimits& given, const char* source) {
    const JointLimits by = given.complete();
    for (Eigen::Index i = 0; i < limits_.lower.size(); ++i) {
      for (std::size_t k = 0; k < kBounds.size(); ++k) {
        double& bound = (limits_.*kBounds[k].second)(i);
        const double other = (by.*kBounds[k].second)(i);
        if (k == 0 ? other > bound : other < bound) {
          bound = other;
          sources_[static_cast<std::size_t>(i)][k] = source;
        }
      }
      if (!std::isfinite(by.deceleration(i))) continue;
      limits_.deceleration(i) = by.deceleration(i);
      limits_.velocity_offset(i) = by.velocity_offset(i);
    }
  }

  /// The limits of joint i in words.
  [[nodiscard]] std::string text(Eigen::Index i) const {
    std::ostringstream text;
    for (std::size_t k = 0; k < kBounds.size(); ++k) {
      const double bound = (limits_.*kBounds[k].second)(i);
      text << (k > 0 ? ", " : "") << kBounds[k].first << ' ' << bound;
      if (std::isfinite(bound)) text << " (" << sources_[static_cast<std::size_t>(i)][k] << ')';
    }
    return text.str();
  }

 private:
  using Bound = std::pair<const char*, fpbm::Vector<Eigen::Dynamic> JointLimits::*>;
  static constexpr std::array<Bound, 6> kBounds{{{"lower", &JointLimits::lower},
                                                 {"upper", &JointLimits::upper},
                                                 {"velocity", &JointLimits::velocity},
                                                 {"acceleration", &JointLimits::acceleration},
                                                 {"jerk", &JointLimits::jerk},
                                                 {"effort", &JointLimits::effort}}};

  JointLimits limits_;
  std::vector<std::array<const char*, kBounds.size()>> sources_;
};

}  // namespace fpbm_controllers
