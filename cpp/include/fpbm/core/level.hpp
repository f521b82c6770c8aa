#pragma once

namespace fpbm {

/// Output of a scheme: joint velocities or joint accelerations.
enum class Level : unsigned char { kVelocity, kAcceleration };

}  // namespace fpbm
