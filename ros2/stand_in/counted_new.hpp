#pragma once

namespace stand_in {

/// Number of calls of operator new.
inline long allocations = 0;

}  // namespace stand_in
