// As much of ros2_control's controller_interface as the skeleton uses.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "rclcpp/duration.hpp"
#include "rclcpp/time.hpp"
#include "rclcpp_lifecycle/state.hpp"

namespace rclcpp {

struct Logger {};

class Parameter {
 public:
  using Value = std::variant<std::string, std::vector<std::string>>;
  explicit Parameter(Value value) : value_(std::move(value)) {}
  std::string as_string() const { return std::get<std::string>(value_); }
  std::vector<std::string> as_string_array() const { return std::get<std::vector<std::string>>(value_); }

 private:
  Value value_;
};

}  // namespace rclcpp

namespace rclcpp_lifecycle {

class LifecycleNode {
 public:
  rclcpp::Logger get_logger() const { return {}; }
  rclcpp::Parameter get_parameter(const std::string &name) const { return rclcpp::Parameter(parameters.at(name)); }
  std::map<std::string, rclcpp::Parameter::Value> parameters;
};

}  // namespace rclcpp_lifecycle

namespace hardware_interface {

class LoanedCommandInterface {
 public:
  explicit LoanedCommandInterface(double *value) : value_(value) {}
  [[nodiscard]] bool set_value(double value) {
    *value_ = value;
    return true;
  }

 private:
  double *value_;
};

class LoanedStateInterface {
 public:
  explicit LoanedStateInterface(const double *value) : value_(value) {}
  std::optional<double> get_optional() const { return *value_; }

 private:
  const double *value_;
};

}  // namespace hardware_interface

namespace controller_interface {

enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class return_type { OK, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration {
  interface_configuration_type type;
  std::vector<std::string> names;
};

class ControllerInterface {
 public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State &previous) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State &previous) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State &previous) = 0;
  virtual return_type update(const rclcpp::Time &time, const rclcpp::Duration &period) = 0;

  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> get_node() const { return node_; }
  void assign_interfaces(std::vector<hardware_interface::LoanedCommandInterface> &&commands,
                         std::vector<hardware_interface::LoanedStateInterface> &&states) {
    command_interfaces_ = std::move(commands);
    state_interfaces_ = std::move(states);
  }

 protected:
  template <class Value>
  Value auto_declare(const std::string &name, const Value &value) {
    return std::get<Value>(node_->parameters.try_emplace(name, value).first->second);
  }
  std::vector<hardware_interface::LoanedCommandInterface> command_interfaces_;
  std::vector<hardware_interface::LoanedStateInterface> state_interfaces_;

 private:
  std::shared_ptr<rclcpp_lifecycle::LifecycleNode> node_ = std::make_shared<rclcpp_lifecycle::LifecycleNode>();
};

}  // namespace controller_interface
