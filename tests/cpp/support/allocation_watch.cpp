#include "support/allocation_watch.hpp"

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <new>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define FPBM_TEST_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || !defined(__GLIBC__)
#define FPBM_TEST_SANITIZED
#endif

namespace fpbm::test {
namespace {

// Constant-initialised variables are valid for allocations before main().
thread_local bool watching = false;
thread_local AllocationCount counted;

}  // namespace

void count_eigen_assertion() noexcept {
  counted.by_eigen += watching ? 1 : 0;
}

AllocationWatch::AllocationWatch() noexcept {
  counted = {};
  watching = true;
  Eigen::internal::set_is_malloc_allowed(false);
}

AllocationWatch::~AllocationWatch() noexcept {
  watching = false;
  Eigen::internal::set_is_malloc_allowed(true);
}

AllocationCount AllocationWatch::count() const noexcept {
  return counted;
}

#ifdef FPBM_TEST_SANITIZED
const bool AllocationWatch::kSeesMalloc = false;
#else
const bool AllocationWatch::kSeesMalloc = true;
#endif

}  // namespace fpbm::test

// malloc and its family: with glibc, a program can define its own functions. The functions of glibc keep these names.
#ifndef FPBM_TEST_SANITIZED
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

namespace {
void count_malloc() noexcept {
  fpbm::test::counted.by_malloc += fpbm::test::watching ? 1 : 0;
}
}  // namespace

void* malloc(std::size_t size) noexcept {
  count_malloc();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  count_malloc();
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) noexcept {
  count_malloc();
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count_malloc();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count_malloc();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  count_malloc();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}
#endif

namespace {

/// Implements all forms of new. Bypasses the watch on malloc, so that each watch counts only its own allocations.
void* allocate(std::size_t size, std::size_t alignment) noexcept {
  fpbm::test::counted.by_new += fpbm::test::watching ? 1 : 0;
#ifdef FPBM_TEST_SANITIZED
  void* memory = nullptr;
  return posix_memalign(&memory, alignment, size) == 0 ? memory : nullptr;
#else
  return __libc_memalign(alignment, size);
#endif
}

void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  void* memory = allocate(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

constexpr std::size_t kAlignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__;

}  // namespace

void* operator new(std::size_t size) {
  return allocate_or_throw(size, kAlignment);
}
void* operator new[](std::size_t size) {
  return allocate_or_throw(size, kAlignment);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, kAlignment);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size, kAlignment);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
  std::free(memory);
}
