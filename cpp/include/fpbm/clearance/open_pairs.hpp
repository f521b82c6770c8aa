#pragma once

#include <cstddef>
#include <vector>

namespace fpbm {

/// Numbers of the pairs that a question is still open about: first all, then but those that are not settled.
class OpenPairs {
 public:
  /// Room for so many; the only function that allocates.
  void resize(std::size_t pairs) { open_.resize(pairs); }

  void open_all() noexcept {
    for (std::size_t i = 0; i < open_.size(); ++i) open_[i] = i;
    count_ = open_.size();
  }

  /// Leaves those out that settled(pair) says are settled.
  template <typename Settled>
  void close_if(const Settled& settled) noexcept {
    std::size_t left = 0;
    for (std::size_t k = 0; k < count_; ++k) {
      if (!settled(open_[k])) open_[left++] = open_[k];
    }
    count_ = left;
  }

 private:
  std::vector<std::size_t> open_;
  std::size_t count_ = 0;
};

}  // namespace fpbm
