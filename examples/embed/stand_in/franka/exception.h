#pragma once

#include <stdexcept>

// Stand-in for the header of libfranka with this name.
namespace franka {

struct Exception : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace franka
