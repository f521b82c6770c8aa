#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace fpbm {

/// The model of a robot, or a model with a lighter payload and a model with a heavier payload. No heap allocation.
template <typename Model>
class TorqueModels {
 public:
  TorqueModels(const Model& model, const std::optional<Model>& lighter)
      : models_{lighter ? *lighter : model, model}, size_(lighter ? 2 : 1) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] const Model& operator[](std::size_t k) const noexcept { return models_[k]; }
  [[nodiscard]] const Model& back() const noexcept { return models_[1]; }
  [[nodiscard]] const Model* begin() const noexcept { return models_.data(); }
  [[nodiscard]] const Model* end() const noexcept { return models_.data() + size_; }

 private:
  std::array<Model, 2> models_;
  std::size_t size_;
};

}  // namespace fpbm
