#include <cmath>
#include <cstdio>
#include <fpbm/geometry/detail/sincos.hpp>
#include <fpbm/linalg/detail/sums.hpp>
#include <limits>

/// Succeeds if sine and cosine are right, alone and in a vector, and non-finite numbers are detected.
namespace {

double worst = 0.0;

/// As a double: registers of the 8087 hold more digits, and larger numbers.
double stored(double number) {
  volatile double memory = number;
  return memory;
}

void compare(double angle, double sine, double cosine) {
  const long double exact = angle;
  worst = std::fmax(worst, std::fabs(static_cast<double>(std::sin(exact) - static_cast<long double>(sine))));
  worst = std::fmax(worst, std::fabs(static_cast<double>(std::cos(exact) - static_cast<long double>(cosine))));
}

}  // namespace

int main() {
  constexpr double kReach = fpbm::ReducedSinCos::kReach;
  for (const double range : {1.0, 10.0, 1e3, kReach}) {
    for (int i = -5000; i <= 5000; ++i) {
      const double angle = stored(range * i / 5000.0);
      const fpbm::SinCos<double> alone = fpbm::sincos(angle);
      compare(angle, alone.sin, alone.cos);
      const double quarter = stored(std::nearbyint(angle / 1.5707963267948966) * 1.5707963267948966);
      const fpbm::Vector<4> angles(angle, -angle, quarter, 0.0);
      fpbm::Vector<4> sines;
      fpbm::Vector<4> cosines;
      fpbm::sincos(angles, sines, cosines);
      for (Eigen::Index j = 0; j < 4; ++j) compare(angles(j), sines(j), cosines(j));
    }
  }

  const double largest = stored(std::numeric_limits<double>::max());
  const double infinity = stored(2.0 * largest);
  const double nan = stored(infinity - infinity);
  const bool seen = !fpbm::is_finite(fpbm::Vector<2>(1.0, infinity)) && !fpbm::is_finite(fpbm::Vector<2>(nan, 1.0)) &&
                    fpbm::is_finite(fpbm::Vector<2>(1.0, largest));
  std::printf("off by %.1e; what is not finite is %s\n", worst, seen ? "seen" : "not seen");
  return worst <= 4e-16 && seen ? 0 : 1;
}
