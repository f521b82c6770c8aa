#include "fpbm/core/lanes.hpp"
#include "fpbm/fpbm.hpp"  // clang-tidy reads every header through this file.
