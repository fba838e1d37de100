/* A robot for the programs in the documentation: free air, one that follows, 3000 ticks. It ends with 1 where the tool has
 * not moved on to its goal. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "hpf.h"
#include "skill.h"

void read_force(double *force);
int send_command(const hpf_f64_axis_output_t *axis);

void read_force(double *force) { *force = 0.0; }

int send_command(const hpf_f64_axis_output_t *axis) {
  static int tick;
  if (++tick < 3000) return 1;
  if (fabs(axis->position - hpf_reach_goal[0]) > 1e-3) {
    printf("the tool is at %g m and not at its goal, %g m\n", axis->position, hpf_reach_goal[0]);
    exit(1);
  }
  return 0;
}
