// Counts the allocations of the test by replacing the operators new.

#include "counted_new.hpp"

#include <cstdlib>
#include <new>

void* operator new(std::size_t size) {
  ++stand_in::allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
