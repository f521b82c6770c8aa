#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

#include "fpbm/core/types.hpp"

namespace fpbm::validation {

// A number or a text as messages show it, after what they say before. Never inlined: messages are for arguments that
// are rejected.
[[gnu::noinline, gnu::cold]] inline void append_text(std::string& message, std::string_view text) {
  message += text;
}
[[gnu::noinline, gnu::cold]] inline void append_text(std::string& message, double value) {
  char number[32];
  std::snprintf(number, sizeof number, "%.9g", value);
  message += number;
}
template <typename Whole>
[[gnu::cold]] std::enable_if_t<std::is_integral_v<Whole>> append_text(std::string& message, Whole value) {
  message += std::to_string(value);
}

/// An argument of a constructor, or a part of it, for messages: element("joints", 2) + ".axis" is "joints[2].axis".
///
/// Refers to the texts that it is made of. They are joined only for a message, so that checks take no memory.
class Argument {
 public:
  Argument(const char* name) : Argument(std::string_view(name)) {}
  Argument(const std::string& name) : Argument(std::string_view(name)) {}
  [[gnu::noinline]] Argument(std::string_view name) { append({name}); }
  Argument(std::string&& name) = delete;

  /// A part of it, by name.
  [[nodiscard, gnu::noinline]] friend Argument operator+(Argument argument, std::string_view part) {
    argument.append({part});
    return argument;
  }

  friend Argument element(Argument argument, Eigen::Index i, Eigen::Index j);

  [[nodiscard]] std::string text() const { return joined(count_); }

  /// What the last index is an index of; all of it where there is none.
  [[nodiscard]] std::string name() const {
    const std::size_t last = last_index();
    return joined(last < count_ ? last : count_);
  }

  /// The last index; -1 where there is none.
  [[nodiscard]] int index() const {
    const std::size_t last = last_index();
    return last < count_ ? static_cast<int>(parts_[last].i) : -1;
  }

 private:
  /// A name, or else an index.
  struct Part {
    std::string_view name;
    Eigen::Index i = -1;
    Eigen::Index j = -1;
  };

  void append(const Part& part) noexcept {
    if (count_ < parts_.size()) parts_[count_++] = part;
  }

  /// The place of the last index, or the number of parts.
  [[nodiscard]] std::size_t last_index() const noexcept {
    for (std::size_t k = count_; k-- > 0;) {
      if (parts_[k].i >= 0) return k;
    }
    return count_;
  }

  [[nodiscard]] std::string joined(std::size_t count) const {
    std::string text;
    for (std::size_t k = 0; k < count; ++k) {
      const auto& [name, i, j] = parts_[k];
      text += name;
      if (i >= 0) text += "[" + std::to_string(i) + (j >= 0 ? ", " + std::to_string(j) : "") + "]";
    }
    return text;
  }

  std::array<Part, 8> parts_ = {};  ///< The deepest, joint 'elbow'.placement.p[1], has six.
  std::size_t count_ = 0;
};

/// Entry i of an argument; of a matrix, entry (i, j).
[[nodiscard, gnu::noinline]] inline Argument element(Argument argument, Eigen::Index i, Eigen::Index j = -1) {
  argument.append({{}, i, j});
  return argument;
}

}  // namespace fpbm::validation
