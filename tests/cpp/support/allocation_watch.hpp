#pragma once

/// Eigen can report its allocations: before each it asserts that a flag allows it, and this program counts where that
/// fails. Include this header before any of Eigen's, which the macros below change.
#ifdef EIGEN_CORE_MODULE_H
#error "allocation_watch.hpp must come before Eigen"
#endif

namespace fpbm::test {
void count_eigen_assertion() noexcept;

/// Whether the text of an assertion is that of the one before an allocation. The others are left out: they take long to
/// compile, and other builds check them.
constexpr bool is_about_allocation(const char* text) noexcept {
  for (const char* expected = "is_malloc_allowed()"; *expected != '\0'; ++expected, ++text) {
    if (*text != *expected) return false;
  }
  return true;
}
}  // namespace fpbm::test

#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition)                                    \
  do {                                                             \
    if constexpr (::fpbm::test::is_about_allocation(#condition)) { \
      if (!(condition)) ::fpbm::test::count_eigen_assertion();     \
    }                                                              \
  } while (false)

#include <Eigen/Core>

namespace fpbm::test {

/// Allocations seen by each of three watches.
struct AllocationCount {
  int by_new = 0;     ///< operator new, in all its forms.
  int by_malloc = 0;  ///< malloc and its family. Not watched under sanitizers, which need it for themselves.
  int by_eigen = 0;   ///< Eigen's own check.

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
