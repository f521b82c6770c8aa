#include "fpbm/core/lanes.hpp"
#include "fpbm/fpbm.hpp"  // What clang-tidy reads to see every header.
