#include "lanes.hpp"

namespace fpbm::bindings {
namespace {

const LaneCode* used = nullptr;

}  // namespace

const LaneCode* lane_code() noexcept {
  return used;
}

void use_lane_code(const LaneCode* code) noexcept {
  used = code;
}

}  // namespace fpbm::bindings
