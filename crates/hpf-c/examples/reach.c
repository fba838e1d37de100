/* A 1 kHz loop in C: two axes in double precision, a wall, a pause, then what refusals look like. */
#include <math.h>
#include <stdio.h>

#include "hpf.h"

#define AXES 2
#define BASES 20

/* The lists of a policy: constant, so they may lie in flash. */
static const double still[BASES] = {0};
static double stiff[BASES], damp[BASES];

/* One shared basis, lists borrowed: 2 numbers per function. */
static uint64_t memory[HPF_F64_BYTES(AXES, 2 * BASES) / sizeof(uint64_t) + 1];

static int refused(const char *what, int32_t status, int32_t expected) {
  printf("%-26s %s\n", what, hpf_status_text(status));
  return status != expected;
}

int main(void) {
  const hpf_f64_limits_t limits[AXES] = {
      {50.0, 0.2, 1.0, 20.0, -0.5, 0.6},
      {50.0, 0.2, 1.0, 20.0, -0.5, 0.6},
  };
  const double goal[AXES] = {0.3, -0.2}, start[AXES] = {0.0, 0.0};
  hpf_f64_policy_t policy;
  hpf_f64_settings_t settings;
  hpf_f64_input_t input;
  hpf_f64_output_t output;
  hpf_counters_t counters;
  hpf_error_t error;
  hpf_f64_controller_t *arm = NULL;
  size_t bytes = 0;
  int i, tick, ended = 0, failures = 0;

  HPF_PREPARE(policy);
  HPF_PREPARE(settings);
  HPF_PREPARE(input);
  HPF_PREPARE(output);
  HPF_PREPARE(counters);
  HPF_PREPARE(error);

  for (i = 0; i < BASES; i++) {
    stiff[i] = 100.0 + 5.0 * i;
    damp[i] = 40.0;
  }
  policy.axes = AXES;
  policy.lists = HPF_LISTS_BORROWED;
  policy.duration = 2.0;
  policy.decay = 4.605170185988092;
  policy.movement_basis.family = HPF_BASIS_TIME;
  policy.movement_basis.count = BASES;
  policy.movement_basis.overlap = 0.6;
  policy.stiffness_basis = policy.damping_basis = policy.movement_basis;
  for (i = 0; i < AXES; i++) {
    hpf_f64_axis_policy_t *axis = &policy.axis[i];
    axis->goal = goal[i];
    axis->alpha = 25.0;
    axis->forcing_scale = goal[i];
    axis->movement_weights = still;
    axis->stiffness_min = 30.0;
    axis->stiffness_max = 400.0;
    axis->stiffness_weights = stiff;
    axis->damping_min = 10.0;
    axis->damping_max = 100.0;
    axis->damping_weights = damp;
  }
  if (hpf_f64_compliant(&settings, AXES, limits) != HPF_OK) return 1;
  if (hpf_f64_size(hpf_f64_axes_2(), &policy, &bytes) != HPF_OK || bytes > sizeof memory) return 1;
  printf("the controller needs %lu of %lu bytes\n", (unsigned long)bytes, (unsigned long)sizeof memory);
  if (hpf_f64_create(hpf_f64_axes_2(), memory, sizeof memory, &policy, &settings, start, &arm, &error) != HPF_OK) {
    printf("refused: %s\n", error.text);
    return 1;
  }

  printf("  t [s]  mode  position [m]      offset [mm]\n");
  for (tick = 0; tick < 4000; tick++) {
    double into_wall = output.axis[0].position - 0.25;
    input.measured_force[0] = into_wall > 0.0 ? -1000.0 * into_wall : 0.0;
    input.rate = 1.0;
    input.request = tick == 0      ? HPF_START
                    : tick == 500  ? HPF_HOLD
                    : tick == 1000 ? HPF_RESUME
                                   : HPF_NO_REQUEST;
    if (hpf_f64_update(arm, &input, 1e-3, &output) != HPF_OK) return 1;
    ended += (output.flags & HPF_ENDED) != 0;
    if ((tick + 1) % 500 == 0) {
      printf("%7.2f  %4u  %7.4f %7.4f  %11.2f\n", (tick + 1) * 1e-3, (unsigned)output.mode, output.axis[0].position,
             output.axis[1].position, 1e3 * output.axis[0].offset);
    }
  }
  /* Axis 0 rests between wall and goal, k (0.3 - x) = 1000 (x - 0.25) with k = 195; axis 1 is at its goal. */
  failures += ended != 1 || output.mode != HPF_MODE_RUN;
  failures += fabs(output.axis[0].position - (195.0 * 0.3 + 1000.0 * 0.25) / 1195.0) > 1e-3;
  failures += fabs(output.axis[1].position - goal[1]) > 1e-3;

  input.request = HPF_NO_REQUEST;
  input.measured_force[0] = NAN; /* not an error: the last good force stands in, for a while */
  failures += hpf_f64_update(arm, &input, 1e-3, &output) != HPF_OK || !(output.flags & HPF_BAD_FORCE);
  failures += hpf_f64_counters(arm, &counters) != HPF_OK || counters.bad_force != 1 || counters.refused != 0;

  failures += refused("no input:", hpf_f64_update(arm, NULL, 1e-3, &output), HPF_NULL_POINTER);
  input.request = 99;
  failures += refused("request 99:", hpf_f64_update(arm, &input, 1e-3, &output), HPF_UNKNOWN_CHOICE);
  output.abi_version = HPF_ABI_VERSION + 1;
  failures += refused("output of another version:", hpf_f64_output(arm, &output), HPF_WRONG_VERSION);
  settings.ramp = NAN;
  failures += refused("a ramp that is NaN:", hpf_f64_set(arm, &settings, &error), HPF_NOT_FINITE);
  printf("%-26s %s\n", "in full:", error.text);
  failures += refused("too little memory:",
                      hpf_f64_create(hpf_f64_axes_2(), memory, 100, &policy, &settings, start, &arm, &error),
                      HPF_TOO_SMALL);
  failures += arm != NULL;
  printf(failures ? "FAILED\n" : "as expected\n");
  return failures != 0;
}
