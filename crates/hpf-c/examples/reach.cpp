// The same interface from C++: one axis in single precision, the basis and its lists copied into the controller's memory.
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "hpf.h"

namespace {

template <class Struct>
Struct prepared() {
  Struct object;
  HPF_PREPARE(object);
  return object;
}

void require(std::int32_t status) {
  if (status != HPF_OK) throw std::runtime_error(hpf_status_text(status));
}

// Owns the memory of a controller, which stays where it is when the object moves.
class Arm {
 public:
  Arm(const hpf_f32_policy_t &policy, const hpf_f32_settings_t &settings, const float *position) {
    const hpf_f32_instance_t *instance = hpf_f32_instance(policy.axes);
    std::size_t bytes = 0;
    require(hpf_f32_size(instance, &policy, &bytes));
    memory_.resize((bytes + 7) / 8);
    auto error = prepared<hpf_error_t>();
    if (hpf_f32_create(instance, memory_.data(), 8 * memory_.size(), &policy, &settings, position, &controller_, &error) !=
        HPF_OK) {
      throw std::invalid_argument(error.text);
    }
  }
  Arm(const Arm &) = delete;
  Arm &operator=(const Arm &) = delete;
  Arm(Arm &&) = default;
  Arm &operator=(Arm &&) = default;

  hpf_f32_output_t update(const hpf_f32_input_t &input, float dt) {
    auto output = prepared<hpf_f32_output_t>();
    require(hpf_f32_update(controller_, &input, dt, &output));
    return output;
  }

 private:
  std::vector<std::uint64_t> memory_;
  hpf_f32_controller_t *controller_ = nullptr;
};

Arm make(float stiffness) {
  std::array<float, 5> weights{}, stiff{}, damp{};
  stiff.fill(stiffness);
  damp.fill(40.0F);
  auto policy = prepared<hpf_f32_policy_t>();
  policy.axes = 1;
  policy.duration = 1.0F;
  policy.decay = 4.6F;
  policy.movement_basis.count = 5;
  policy.movement_basis.overlap = 0.6F;
  policy.stiffness_basis = policy.damping_basis = policy.movement_basis;
  policy.axis[0].goal = 0.3F;
  policy.axis[0].alpha = 25.0F;
  policy.axis[0].forcing_scale = 0.3F;
  policy.axis[0].movement_weights = weights.data();
  policy.axis[0].stiffness_min = 30.0F;
  policy.axis[0].stiffness_max = 400.0F;
  policy.axis[0].stiffness_weights = stiff.data();
  policy.axis[0].damping_min = 10.0F;
  policy.axis[0].damping_max = 100.0F;
  policy.axis[0].damping_weights = damp.data();

  const hpf_f32_limits_t limits{50.0F, 0.2F, 1.0F, 20.0F, -0.1F, 0.6F};
  auto settings = prepared<hpf_f32_settings_t>();
  require(hpf_f32_compliant(&settings, 1, &limits));
  const float position = 0.0F;
  return Arm(policy, settings, &position);  // the lists may go: they were copied
}

}  // namespace

int main() {
  Arm arm = make(100.0F);
  auto input = prepared<hpf_f32_input_t>();
  input.rate = 1.0F;
  input.measured_force[0] = 10.0F;
  input.request = HPF_START;
  hpf_f32_output_t output{};
  for (int tick = 0; tick < 4000; ++tick) {
    output = arm.update(input, 1e-3F);
    input.request = HPF_NO_REQUEST;
  }
  std::printf("at the goal, 10 N give 10/100 m: %.4f m\n", static_cast<double>(output.axis[0].position));
  if (std::fabs(output.axis[0].position - 0.4F) > 1e-3F) return 1;

  try {
    make(NAN);
  } catch (const std::invalid_argument &refusal) {
    std::printf("refused: %s\n", refusal.what());
    return 0;
  }
  return 1;
}
