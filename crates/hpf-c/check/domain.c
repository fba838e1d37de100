/* Damping down to subnormal numbers through the border: a skill that is taken gives finite commands within its limits,
 * whatever force, step and limits; one whose damping no step could bear is refused. */
#include <math.h>
#include <stdio.h>

#include "hpf.h"

#define BASES 20

static uint64_t memory[HPF_F64_BYTES(1, 10 * BASES) / sizeof(uint64_t) + 1];

/* 1: refused, 0: within its limits, -1: not. */
static int tried(double damping, const hpf_f64_limits_t *limits, double force, double dt) {
  double soft[BASES], stiff[BASES], still[BASES] = {0.0}, last = 0.0;
  const double position[1] = {0.0};
  hpf_f64_policy_t policy;
  hpf_f64_settings_t settings;
  hpf_f64_input_t input;
  hpf_f64_output_t output;
  hpf_error_t error;
  hpf_f64_controller_t *arm = NULL;
  int tick;

  HPF_PREPARE(policy);
  HPF_PREPARE(settings);
  HPF_PREPARE(input);
  HPF_PREPARE(output);
  HPF_PREPARE(error);
  for (tick = 0; tick < BASES; tick++) {
    soft[tick] = damping;
    stiff[tick] = 100.0;
  }
  policy.axes = 1;
  policy.duration = 2.0;
  policy.decay = 4.6;
  policy.movement_basis.count = BASES;
  policy.movement_basis.overlap = 0.6;
  policy.stiffness_basis = policy.damping_basis = policy.movement_basis;
  policy.axis[0].goal = 0.3;
  policy.axis[0].alpha = 25.0;
  policy.axis[0].forcing_scale = 0.3;
  policy.axis[0].movement_weights = still;
  policy.axis[0].stiffness_min = 1.0;
  policy.axis[0].stiffness_max = 400.0;
  policy.axis[0].stiffness_weights = stiff;
  policy.axis[0].damping_min = damping;
  policy.axis[0].damping_max = 100.0;
  policy.axis[0].damping_weights = soft;
  if (hpf_f64_compliant(&settings, 1, limits) != HPF_OK) return -1;
  if (hpf_f64_create(hpf_f64_axes_1(), memory, sizeof memory, &policy, &settings, position, &arm, &error) != HPF_OK) {
    return error.status == HPF_OUT_OF_RANGE ? 1 : -1;
  }
  input.rate = 1.0;
  input.request = HPF_START;
  input.measured_force[0] = force;
  for (tick = 0; tick < 4000; tick++) {
    const hpf_f64_axis_output_t *axis = &output.axis[0];
    if (hpf_f64_update(arm, &input, dt, &output) != HPF_OK) return -1;
    input.request = HPF_NO_REQUEST;
    /* Not finite is not within either. */
    if (!(fabs(axis->offset) <= limits->offset * (1.0 + 1e-9))) return -1;
    if (!(fabs(axis->position - last) <= limits->velocity * dt * (1.0 + 1e-9) + 1e-12)) return -1;
    last = axis->position;
  }
  return 0;
}

int main(void) {
  const double dampings[] = {1e-320, 1e-310, 1e-300, 1e-100, 1e-3, 10.0};
  const double forces[] = {5.0, -20.0, 49.0}, accelerations[] = {1.0, 50.0, 1e6}, steps[] = {1e-3, 8e-3};
  hpf_f64_limits_t limits = {50.0, 0.2, 0.5, 50.0, -0.1, 0.6};
  int d, f, a, s, count[2] = {0, 0};

  for (d = 0; d < 6; d++) {
    for (f = 0; f < 3; f++) {
      for (a = 0; a < 3; a++) {
        for (s = 0; s < 2; s++) {
          int found;
          limits.acceleration = accelerations[a];
          found = tried(dampings[d], &limits, forces[f], steps[s]);
          if (found < 0 || (d < 3) > found) {
            printf("damping %g, force %g, acceleration %g, dt %g: %d\n", dampings[d], forces[f], accelerations[a],
                   steps[s], found);
            return 1;
          }
          count[found]++;
        }
      }
    }
  }
  printf("%d refused, %d within their limits\n", count[1], count[0]);
  return count[0] < 18;
}
