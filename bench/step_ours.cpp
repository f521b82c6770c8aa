#include "step.hpp"

namespace {
[[maybe_unused]] const bool kAdded = bench::add_library<bench::Ours>();
}
