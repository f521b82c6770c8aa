#pragma once

namespace fpbm {

/// What a scheme returns: joint velocities or joint accelerations.
enum class Level : unsigned char { kVelocity, kAcceleration };

}  // namespace fpbm
