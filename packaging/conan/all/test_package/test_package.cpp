#include <cstdio>
#include <fpbm/fpbm.hpp>

int main() {
  using Task = fpbm::Position<2>;
  const fpbm::PlanarArm<4> arm(fpbm::Vector<4>::Ones());
  const auto scheme = fpbm::FPBM<4>(0.6, fpbm::Vector<4>(1, 2, 3, 4), 1.0, 1.0);
  fpbm::Tracker tracker(arm, Task{}, scheme, fpbm::Vector<4>::Constant(0.2));
  const fpbm::Status status = tracker.tick(fpbm::Reference<Task>::hold(tracker.tip())).status;
  std::printf("%s\n", message(status));
  return failed(status) ? 1 : 0;
}
