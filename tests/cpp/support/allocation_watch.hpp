#pragma once

/// Eigen tells on itself: it checks a flag before it allocates, by an assertion that this program turns into a count.
/// To be included before any header of Eigen's, which the macros below are for.
#ifdef EIGEN_CORE_MODULE_H
#error "allocation_watch.hpp must come before Eigen"
#endif

namespace fpbm::test {
void count_eigen_assertion() noexcept;
}

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition)                              \
  do {                                                       \
    if (!(condition)) ::fpbm::test::count_eigen_assertion(); \
  } while (false)

#include <Eigen/Core>

namespace fpbm::test {

/// Allocations seen by each of three watches.
struct AllocationCount {
  int by_new = 0;     ///< operator new, in all its forms.
  int by_malloc = 0;  ///< malloc and its family. Not watched under sanitizers, which need it for themselves.
  int by_eigen = 0;   ///< Eigen's own check (or another of its assertions).

  [[nodiscard]] int total() const noexcept { return by_new + by_malloc + by_eigen; }
};

/// Watches for allocations as long as it lives, on this thread. Counts and reports; never stops the program.
class AllocationWatch {
 public:
  AllocationWatch() noexcept;
  ~AllocationWatch() noexcept;
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;

  [[nodiscard]] AllocationCount count() const noexcept;

  static const bool kSeesMalloc;
};

}  // namespace fpbm::test
