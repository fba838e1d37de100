// A ros2_control controller that runs a skill: force sensor in, position commands out. A skeleton to start from.
//
// Parameters: joints (names of the joints, one per axis of the skill), sensor (name of the force sensor), forces (names of
// its interfaces, one per joint). Claims <joint>/position to command, reads <joint>/position and <sensor>/<force>.
//
// The axes are those of the skill: where joints and forces are not in one frame, put the robot's kinematics between.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "controller_interface/controller_interface.hpp"
#include "hpf.h"
#include "rclcpp/duration.hpp"
#include "rclcpp/time.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace hpf_controller {

class HpfController : public controller_interface::ControllerInterface {
 public:
  controller_interface::CallbackReturn on_init() override;
  controller_interface::InterfaceConfiguration command_interface_configuration() const override;
  controller_interface::InterfaceConfiguration state_interface_configuration() const override;
  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State &previous) override;
  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State &previous) override;
  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State &previous) override;
  controller_interface::return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) override;

  // What a service or a topic asks for, from any thread: HPF_HOLD, HPF_RESUME or HPF_STOP, done at the next update.
  void request(std::uint32_t request) { request_.store(request); }

  // The last output, for a publisher; read it in the thread of update.
  const hpf_f64_output_t &output() const { return output_; }

 private:
  std::vector<std::string> joints_;
  std::string sensor_;
  std::vector<std::string> forces_;
  std::vector<double> weights_;
  hpf_f64_policy_t policy_{};
  hpf_f64_settings_t settings_{};
  hpf_f64_input_t input_{};
  hpf_f64_output_t output_{};
  std::vector<std::uint64_t> memory_;
  hpf_f64_controller_t *controller_ = nullptr;
  std::atomic<std::uint32_t> request_{HPF_NO_REQUEST};
};

}  // namespace hpf_controller
