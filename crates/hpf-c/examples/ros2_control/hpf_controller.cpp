#include "hpf_controller.hpp"

#include <algorithm>
#include <exception>
#include <limits>

#include "hardware_interface/types/hardware_interface_type_values.hpp"
#include "pluginlib/class_list_macros.hpp"
#include "rclcpp/logging.hpp"

namespace hpf_controller {

using controller_interface::CallbackReturn;
using controller_interface::InterfaceConfiguration;
using controller_interface::interface_configuration_type;
using controller_interface::return_type;

namespace {

constexpr std::uint32_t FUNCTIONS = 20;

// Reads an interface of newer distributions, which may have no value, and of older ones. No value is NaN: the controller
// bridges it, then comes to rest, then is in Fault.
template <class Interface>
auto read(const Interface &interface, int) -> decltype(double(interface.get_optional().value())) {
  return interface.get_optional().value_or(std::numeric_limits<double>::quiet_NaN());
}
template <class Interface>
double read(const Interface &interface, long) {
  return interface.get_value();
}

}  // namespace

CallbackReturn HpfController::on_init() {
  try {
    auto_declare<std::vector<std::string>>("joints", {});
    auto_declare<std::string>("sensor", "");
    auto_declare<std::vector<std::string>>("forces", {});
  } catch (const std::exception &refusal) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", refusal.what());
    return CallbackReturn::ERROR;
  }
  return CallbackReturn::SUCCESS;
}

InterfaceConfiguration HpfController::command_interface_configuration() const {
  InterfaceConfiguration claimed{interface_configuration_type::INDIVIDUAL, {}};
  for (const auto &joint : joints_) claimed.names.push_back(joint + "/" + hardware_interface::HW_IF_POSITION);
  return claimed;
}

InterfaceConfiguration HpfController::state_interface_configuration() const {
  InterfaceConfiguration read{interface_configuration_type::INDIVIDUAL, {}};
  for (const auto &joint : joints_) read.names.push_back(joint + "/" + hardware_interface::HW_IF_POSITION);
  for (const auto &force : forces_) read.names.push_back(sensor_ + "/" + force);
  return read;
}

CallbackReturn HpfController::on_configure(const rclcpp_lifecycle::State &) {
  joints_ = get_node()->get_parameter("joints").as_string_array();
  sensor_ = get_node()->get_parameter("sensor").as_string();
  forces_ = get_node()->get_parameter("forces").as_string_array();
  const auto axes = static_cast<std::uint32_t>(joints_.size());
  if (axes < 1 || axes > HPF_AXES_MAX || forces_.size() != joints_.size()) {
    RCLCPP_ERROR(get_node()->get_logger(), "joints and forces must be 1 to %d names each, not %zu and %zu", HPF_AXES_MAX,
                 joints_.size(), forces_.size());
    return CallbackReturn::ERROR;
  }

  // A straight reach of 0.2 m, soft. A learned skill: the tables of `hpf export POLICY --format c`, instead.
  weights_.assign(3 * FUNCTIONS, 0.0);
  std::fill_n(weights_.begin() + FUNCTIONS, FUNCTIONS, 100.0);
  std::fill_n(weights_.begin() + 2 * FUNCTIONS, FUNCTIONS, 50.0);
  HPF_PREPARE(policy_);
  policy_.axes = axes;
  policy_.lists = HPF_LISTS_BORROWED;  // weights_ outlives the controller
  policy_.duration = 2.0;
  policy_.decay = 4.6;
  policy_.movement_basis.family = HPF_BASIS_TIME;
  policy_.movement_basis.count = FUNCTIONS;
  policy_.movement_basis.overlap = 0.6;
  policy_.stiffness_basis = policy_.damping_basis = policy_.movement_basis;
  std::vector<hpf_f64_limits_t> limits;
  for (std::uint32_t i = 0; i < axes; ++i) {
    auto &axis = policy_.axis[i];
    axis.goal = axis.forcing_scale = 0.2;
    axis.alpha = 25.0;
    axis.movement_weights = weights_.data();
    axis.stiffness_min = 30.0;
    axis.stiffness_max = 400.0;
    axis.stiffness_weights = weights_.data() + FUNCTIONS;
    axis.damping_min = 10.0;
    axis.damping_max = 100.0;
    axis.damping_weights = weights_.data() + 2 * FUNCTIONS;
    limits.push_back({50.0, 0.2, 0.5, 5.0, -0.5, 0.5});
  }
  HPF_PREPARE(settings_);
  std::size_t bytes = 0;
  auto status = hpf_f64_compliant(&settings_, axes, limits.data());
  if (status == HPF_OK) status = hpf_f64_size(hpf_f64_instance(axes), &policy_, &bytes);
  if (status != HPF_OK) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", hpf_status_text(status));
    return CallbackReturn::ERROR;
  }
  memory_.assign((bytes + 7) / 8, 0);
  return CallbackReturn::SUCCESS;
}

CallbackReturn HpfController::on_activate(const rclcpp_lifecycle::State &) {
  // Made anew where the robot is: the first command is the measured position.
  HPF_PREPARE(input_);
  HPF_PREPARE(output_);
  for (std::size_t i = 0; i < joints_.size(); ++i) input_.measured_position[i] = read(state_interfaces_[i], 0);
  hpf_error_t error;
  HPF_PREPARE(error);
  if (hpf_f64_create(hpf_f64_instance(policy_.axes), memory_.data(), 8 * memory_.size(), &policy_, &settings_,
                     input_.measured_position, &controller_, &error) != HPF_OK) {
    RCLCPP_ERROR(get_node()->get_logger(), "%s", error.text);
    return CallbackReturn::ERROR;
  }
  input_.rate = 1.0;
  input_.has_position = 1;
  request(HPF_START);
  return CallbackReturn::SUCCESS;
}

CallbackReturn HpfController::on_deactivate(const rclcpp_lifecycle::State &) {
  controller_ = nullptr;
  return CallbackReturn::SUCCESS;
}

return_type HpfController::update(const rclcpp::Time &, const rclcpp::Duration &period) {
  const std::size_t axes = joints_.size();
  for (std::size_t i = 0; i < axes; ++i) {
    input_.measured_position[i] = read(state_interfaces_[i], 0);
    input_.measured_force[i] = read(state_interfaces_[axes + i], 0);
  }
  // A driver that repeats old readings must say how old: input_.force_age, in periods.
  input_.request = request_.exchange(HPF_NO_REQUEST);
  // A period of zero, as at the first update, repeats the last command.
  if (hpf_f64_update(controller_, &input_, period.seconds(), &output_) != HPF_OK) return return_type::ERROR;
  for (std::size_t i = 0; i < axes; ++i) static_cast<void>(command_interfaces_[i].set_value(output_.axis[i].position));
  return return_type::OK;
}

}  // namespace hpf_controller

PLUGINLIB_EXPORT_CLASS(hpf_controller::HpfController, controller_interface::ControllerInterface)
