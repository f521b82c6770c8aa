#include "limited.hpp"

namespace {
[[maybe_unused]] const bool kAdded = bench::add_limited_library<bench::OursLimited>();
}
