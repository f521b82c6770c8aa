// Stands in for ros2_control's controller manager: takes the controller through its states on an arm that follows its
// commands exactly, and fails where the arm does not move and come to rest again.

#include <algorithm>
#include <array>
#include <cmath>
#include <controller_interface/controller_interface.hpp>
#include <cstdio>

int main() {
  using controller_interface::CallbackReturn;
  std::array<double, 7> q{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785};
  std::vector<hardware_interface::LoanedCommandInterface> commands(q.begin(), q.end());
  std::vector<hardware_interface::LoanedStateInterface> states(q.begin(), q.end());

  const auto controller = stand_in::exported_controller();
  const rclcpp_lifecycle::State state;
  bool good = controller->on_init() == CallbackReturn::SUCCESS &&
              controller->on_configure(state) == CallbackReturn::SUCCESS &&
              controller->command_interface_configuration().names.size() == q.size();
  controller->assign_interfaces(std::move(commands), std::move(states));
  good = good && controller->on_activate(state) == CallbackReturn::SUCCESS;

  double way = 0.0, last_step = 0.0;
  for (int tick = 0; good && tick < 12000; ++tick) {
    const auto before = q;
    good = controller->update({}, {}) == controller_interface::return_type::OK;
    last_step = 0.0;
    for (std::size_t i = 0; i < q.size(); ++i) last_step = std::max(last_step, std::abs(q[i] - before[i]));
    way += last_step;
  }
  std::printf("the fastest joint's way: %.2f rad, at the end %.0e rad a tick\n", way, last_step);
  return good && way > 0.5 && last_step < 1e-6 ? 0 : 1;
}
