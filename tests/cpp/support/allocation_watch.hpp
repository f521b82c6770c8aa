#pragma once

/// Eigen can report its allocations: before each allocation, Eigen asserts that a flag permits it. This program counts
/// the failures of this assertion. Include this header before all headers of Eigen, because the macros below change
/// them.
#ifdef EIGEN_CORE_MODULE_H
#error "allocation_watch.hpp must come before Eigen"
#endif

namespace fpbm::test {
void count_eigen_assertion() noexcept;

/// Whether the text of an assertion belongs to an allocation. The other assertions are omitted: they take long to
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

/// Numbers of allocations from three watches.
struct AllocationCount {
  int by_new = 0;     ///< operator new, in all its forms.
  int by_malloc = 0;  ///< malloc and its family. Not watched under sanitizers, which replace malloc.
  int by_eigen = 0;   ///< The check of Eigen.

  [[nodiscard]] int total() const noexcept { return by_new + by_malloc + by_eigen; }
};

/// Counts the allocations on this thread during its lifetime. Never stops the program.
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
