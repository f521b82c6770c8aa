#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

#include "fpbm/core/types.hpp"

namespace fpbm::validation {

// Append a text or a number to an error message. Not inlined, because only rejected arguments need a message.
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

/// Name of a constructor argument, or of a part of an argument, for error messages: element("joints", 2) + ".axis" is
/// "joints[2].axis".
///
/// An Argument refers to texts without a copy. text() joins the texts. Checks that pass therefore allocate no memory.
class Argument {
 public:
  Argument(const char* name) : Argument(std::string_view(name)) {}
  Argument(const std::string& name) : Argument(std::string_view(name)) {}
  [[gnu::noinline]] Argument(std::string_view name) { append({name}); }
  Argument(std::string&& name) = delete;

  /// Name of a part of an argument.
  [[nodiscard, gnu::noinline]] friend Argument operator+(Argument argument, std::string_view part) {
    argument.append({part});
    return argument;
  }

  friend void append_text(std::string& message, const Argument& argument) { message += argument.text(); }

  friend Argument element(Argument argument, Eigen::Index i, Eigen::Index j);

  [[nodiscard]] std::string text() const { return joined(count_); }

  /// Text before the last index, or the whole text if there is no index.
  [[nodiscard]] std::string name() const {
    const std::size_t last = last_index();
    return joined(last < count_ ? last : count_);
  }

  /// Last index, or -1 if there is no index.
  [[nodiscard]] int index() const {
    const std::size_t last = last_index();
    return last < count_ ? static_cast<int>(parts_[last].i) : -1;
  }

 private:
  /// A name, or an index if i ≥ 0.
  struct Part {
    std::string_view name;
    Eigen::Index i = -1;
    Eigen::Index j = -1;
  };

  void append(const Part& part) noexcept {
    if (count_ < parts_.size()) parts_[count_++] = part;
  }

  /// Position of the last index in parts_, or count_ if there is no index.
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

  std::array<Part, 8> parts_ = {};  ///< The longest name, joint 'elbow'.placement.p[1], has six parts.
  std::size_t count_ = 0;
};

/// Entry i of a vector, or entry (i, j) of a matrix.
[[nodiscard, gnu::noinline]] inline Argument element(Argument argument, Eigen::Index i, Eigen::Index j = -1) {
  argument.append({{}, i, j});
  return argument;
}

}  // namespace fpbm::validation
