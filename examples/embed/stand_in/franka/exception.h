#pragma once

#include <stdexcept>

// Stands in for libfranka's header of this name.
namespace franka {

struct Exception : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace franka
