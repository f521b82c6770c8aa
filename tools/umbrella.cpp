#include "fpbm/fpbm.hpp"  // What clang-tidy reads to see every header.
