#pragma once

namespace stand_in {

/// How often operator new was called.
inline long allocations = 0;

}  // namespace stand_in
