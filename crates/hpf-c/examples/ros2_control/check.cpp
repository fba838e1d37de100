// Takes the skeleton through its life cycle as a controller manager does, with a robot that follows and a push.
#include <cmath>
#include <cstdio>
#include <limits>

#include "hpf_controller.hpp"

namespace {

using controller_interface::CallbackReturn;
using controller_interface::return_type;

int failed(const char *what) {
  std::printf("FAILED  ros2_control: %s\n", what);
  return 1;
}

}  // namespace

int main() {
  hpf_controller::HpfController controller;
  const rclcpp_lifecycle::State state;
  if (controller.on_init() != CallbackReturn::SUCCESS) return failed("on_init");
  if (controller.on_configure(state) != CallbackReturn::ERROR) return failed("no joints are not refused");
  auto &parameters = controller.get_node()->parameters;
  parameters["joints"] = std::vector<std::string>{"x", "y"};
  parameters["sensor"] = std::string("wrist");
  parameters["forces"] = std::vector<std::string>{"force.x", "force.y"};
  if (controller.on_configure(state) != CallbackReturn::SUCCESS) return failed("on_configure");
  const auto read = controller.state_interface_configuration().names;
  if (controller.command_interface_configuration().names.size() != 2 || read.size() != 4 || read[3] != "wrist/force.y") {
    return failed("interfaces");
  }

  double position[2] = {0.05, -0.05}, force[2] = {0.0, 0.0}, command[2] = {0.0, 0.0};
  using hardware_interface::LoanedCommandInterface;
  using hardware_interface::LoanedStateInterface;
  controller.assign_interfaces({LoanedCommandInterface(&command[0]), LoanedCommandInterface(&command[1])},
                               {LoanedStateInterface(&position[0]), LoanedStateInterface(&position[1]),
                                LoanedStateInterface(&force[0]), LoanedStateInterface(&force[1])});
  if (controller.on_activate(state) != CallbackReturn::SUCCESS) return failed("on_activate");
  const rclcpp::Time time;
  for (int tick = 0; tick < 6000; ++tick) {
    force[0] = tick < 3000 ? 0.0 : 5.0;
    if (tick == 500) controller.request(HPF_HOLD);
    if (tick == 800) controller.request(HPF_RESUME);
    if (controller.update(time, rclcpp::Duration(tick == 0 ? 0.0 : 1e-3)) != return_type::OK) return failed("update");
    if (tick == 0 && (command[0] != 0.05 || command[1] != -0.05)) return failed("the start is not bumpless");
    position[0] = command[0];
    position[1] = command[1];
  }
  if (std::fabs(command[0] - 0.25) > 1e-3 || std::fabs(command[1] - 0.2) > 1e-3) return failed("the goal, 5 N away");
  force[0] = std::numeric_limits<double>::quiet_NaN();
  for (int tick = 0; tick < 500; ++tick) controller.update(time, rclcpp::Duration(1e-3));
  if (controller.output().mode != HPF_MODE_FAULT) return failed("a lost force is no fault");
  if (controller.on_deactivate(state) != CallbackReturn::SUCCESS) return failed("on_deactivate");
  std::printf("ros2_control: at the goal, 5 N give 5/100 m: %.4f m, %.4f m; a lost force is a fault\n", command[0], command[1]);
  return 0;
}
