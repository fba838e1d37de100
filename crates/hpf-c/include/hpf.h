/* The C interface of the HPF controller. Made from the sources of crates/hpf-c; do not edit.
 *
 * Every struct with struct_size and abi_version is prepared by HPF_PREPARE(object). Functions return HPF_OK or the reason
 * of a refusal, hpf_status_text says it in words; a refused call changes nothing but what its comment names. SI units. */

#ifndef HPF_H
#define HPF_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Sets a struct to zero, and its size and version. */
#define HPF_PREPARE(object) \
  (memset(&(object), 0, sizeof(object)), (object).struct_size = (uint32_t)sizeof(object), \
   (object).abi_version = HPF_ABI_VERSION)

/* Upper bounds of hpf_..._size for memory set aside before the program runs; numbers: those of all lists, 2 per function
 * of each basis and, where they are copied, 1 per function, primitive and axis. Use them for arrays of uint64_t. */
#define HPF_F32_BYTES(axes, numbers) (HPF_F32_BYTES_BASE + (axes) * HPF_F32_BYTES_PER_AXIS + (numbers) * 4)
#define HPF_F64_BYTES(axes, numbers) (HPF_F64_BYTES_BASE + (axes) * HPF_F64_BYTES_PER_AXIS + (numbers) * 8)

/*
 Done.
 */
#define HPF_OK 0

/*
 A pointer is null.
 */
#define HPF_NULL_POINTER 1

/*
 A pointer is not aligned to its type; memory for a controller, to HPF_ALIGNMENT.
 */
#define HPF_MISALIGNED 2

/*
 abi_version of a struct is not that of the library: another header was included.
 */
#define HPF_WRONG_VERSION 3

/*
 struct_size of a struct is not that of the library.
 */
#define HPF_WRONG_SIZE 4

/*
 The memory is too small for the controller.
 */
#define HPF_TOO_SMALL 5

/*
 The number of axes is not that of the instance, or above HPF_AXES_MAX.
 */
#define HPF_WRONG_AXES 6

/*
 A basis has fewer than 2 functions or more than HPF_BASES_MAX.
 */
#define HPF_WRONG_BASES 7

/*
 A family, compliance, request or storage is none of its constants.
 */
#define HPF_UNKNOWN_CHOICE 8

/*
 There is no controller here: never made, made with another scalar, or moved.
 */
#define HPF_NO_CONTROLLER 9

/*
 A number is infinite or NaN.
 */
#define HPF_NOT_FINITE 10

/*
 A number that must be positive is not.
 */
#define HPF_NOT_POSITIVE 11

/*
 A number lies outside its bounds.
 */
#define HPF_OUT_OF_RANGE 12

/*
 A lower bound lies above its upper bound.
 */
#define HPF_MIN_ABOVE_MAX 13

/*
 A list is too short.
 */
#define HPF_TOO_FEW 14

/*
 Two lists that belong together differ in length.
 */
#define HPF_LENGTH_MISMATCH 15

/*
 Centers of a basis do not fall from one to the next.
 */
#define HPF_NOT_DECREASING 16

/*
 Version of this interface; every struct carries it.
 */
#define HPF_ABI_VERSION 2

/*
 Most axes of a controller.
 */
#define HPF_AXES_MAX 7

/*
 Most functions of a basis.
 */
#define HPF_BASES_MAX 64

/*
 Family of a basis: Gaussians of the phase, centers equally spaced in time.
 */
#define HPF_BASIS_PHASE 0

/*
 Family of a basis: Gaussians of time, one exponential per step.
 */
#define HPF_BASIS_TIME 1

/*
 Family of a basis: Gaussians of the phase with the given centers and widths, as a policy file has them.
 */
#define HPF_BASIS_STORED 2

/*
 Storage of lists: copied into the controller's memory; the caller's may go.
 */
#define HPF_LISTS_COPIED 0

/*
 Storage of lists: used where they are, in flash; they must stay there, unchanged, as long as the controller is used.
 */
#define HPF_LISTS_BORROWED 1

/*
 Compliance of an axis: gives way by the admittance.
 */
#define HPF_COMPLIANT 0

/*
 Compliance of an axis: follows the reference, force is watched for its trip level only.
 */
#define HPF_RIGID 1

/*
 Compliance of an axis: gives way, and presses on the environment with `press`.
 */
#define HPF_PRESS 2

/*
 Request: none.
 */
#define HPF_NO_REQUEST 0

/*
 Request: start the movement from where the command is.
 */
#define HPF_START 1

/*
 Request: pause on the path.
 */
#define HPF_HOLD 2

/*
 Request: go on along the path.
 */
#define HPF_RESUME 3

/*
 Request: stop on the path for good.
 */
#define HPF_STOP 4

/*
 Request: go to another goal, `target`.
 */
#define HPF_GOAL 5

/*
 Request: call the present force zero; without contact, in Idle, once HPF_TARE_READY is set; refused before.
 */
#define HPF_TARE 6

/*
 Request: back to Idle at the measured position, `target`, of a robot at rest.
 */
#define HPF_RESET 7

/*
 Mode: stands still where it was put, waiting for a start.
 */
#define HPF_MODE_IDLE 0

/*
 Mode: follows the skill; at the goal, holds it compliantly.
 */
#define HPF_MODE_RUN 1

/*
 Mode: pauses on the path, compliant; resumable.
 */
#define HPF_MODE_HOLD 2

/*
 Mode: stopped for good, still compliant where it has moved before; latched until reset.
 */
#define HPF_MODE_STOP 3

/*
 Mode: stopped and rigid, because an input is lost; latched until reset.
 */
#define HPF_MODE_FAULT 4

/*
 Flag of an output: the movement has ended; set once.
 */
#define HPF_ENDED 1

/*
 Flag of an output: dt was not finite or below 1 us, the command stands still.
 */
#define HPF_BAD_TIME 2

/*
 Flag of an output: dt was longer than allowed and was cut.
 */
#define HPF_LONG_TIME 4

/*
 Flag of an output: the force of an axis was not finite, or all of it too old; the last good one stands in.
 */
#define HPF_BAD_FORCE 8

/*
 Flag of an output: a force has been bad for longer than its limit; offsets are frozen, the path stops.
 */
#define HPF_FORCE_LOST 16

/*
 Flag of an output: rate or measured position was not finite and was not used.
 */
#define HPF_BAD_INPUT 32

/*
 Flag of an output: the request was refused.
 */
#define HPF_REFUSED 64

/*
 Flag of an output: a force was above its trip level.
 */
#define HPF_FORCE_TRIPPED 128

/*
 Flag of an output: the robot was further from the command than allowed.
 */
#define HPF_TRACKING_TRIPPED 256

/*
 Flag of an output: the tank has held back stiffness, motion along the path or a force set-point, or the port a
 motion.
 */
#define HPF_ENERGY_SHORT 512

/*
 Flag of an output: a measured position has been bad for longer than its limit; the path stops.
 */
#define HPF_POSITION_LOST 1024

/*
 Flag of an output: the rate has been bad for longer than its limit; the path stops.
 */
#define HPF_RATE_LOST 2048

/*
 Flag of an output: dt has been bad or long for more steps than its limit; the path stops.
 */
#define HPF_TIME_LOST 4096

/*
 Flag of an output, in Idle: the force has stood still long enough for HPF_TARE.
 */
#define HPF_TARE_READY 8192

/*
 Limit that has cut a command: the force into the model.
 */
#define HPF_HIT_FORCE 1

/*
 Limit that has cut a command: the offset from the reference.
 */
#define HPF_HIT_OFFSET 2

/*
 Limit that has cut a command: the velocity.
 */
#define HPF_HIT_VELOCITY 4

/*
 Limit that has cut a command: the acceleration.
 */
#define HPF_HIT_ACCELERATION 8

/*
 Limit that has cut a command: the workspace.
 */
#define HPF_HIT_POSITION 16

/*
 Alignment of the memory for a controller.
 */
#define HPF_ALIGNMENT 8

/*
 Upper bound of what a single-precision controller needs beside its axes and lists.
 */
#define HPF_F32_BYTES_BASE 552

/*
 Upper bound of what each axis adds, without lists.
 */
#define HPF_F32_BYTES_PER_AXIS 392

/*
 Upper bound of what a double-precision controller needs beside its axes and lists.
 */
#define HPF_F64_BYTES_BASE 800

/*
 Upper bound of what each axis adds, without lists.
 */
#define HPF_F64_BYTES_PER_AXIS 720

/*
 A controller in the caller's memory; opaque to C.
 */
typedef struct hpf_f32_controller_t hpf_f32_controller_t;

/*
 A controller in the caller's memory; opaque to C.
 */
typedef struct hpf_f64_controller_t hpf_f64_controller_t;

/*
 The functions of the controllers of one scalar and number of axes; opaque to C.
 */
typedef struct hpf_f32_instance_t hpf_f32_instance_t;

/*
 The functions of the controllers of one scalar and number of axes; opaque to C.
 */
typedef struct hpf_f64_instance_t hpf_f64_instance_t;

/*
 A basis of 2 to HPF_BASES_MAX functions.
 */
typedef struct hpf_f64_basis_t {
  /*
   HPF_BASIS_...
   */
  uint32_t family;
  /*
   Number of functions.
   */
  uint32_t count;
  /*
   Height at which neighbours meet, in (0, 1); not used by HPF_BASIS_STORED.
   */
  double overlap;
  /*
   HPF_BASIS_STORED: centers, oldest phase first.
   */
  const double *centers;
  /*
   HPF_BASIS_STORED: widths.
   */
  const double *widths;
} hpf_f64_basis_t;

/*
 The primitives of one axis and its law; lists have one weight per function of their basis, oldest phase first.
 */
typedef struct hpf_f64_axis_policy_t {
  /*
   Where the movement starts [axis unit].
   */
  double start;
  /*
   Where it ends [axis unit].
   */
  double goal;
  /*
   Spring factor.
   */
  double alpha;
  /*
   Scale of the forcing term [axis unit].
   */
  double forcing_scale;
  /*
   Weights of the movement.
   */
  const double *movement_weights;
  /*
   Smallest stiffness [N/m].
   */
  double stiffness_min;
  /*
   Largest stiffness [N/m].
   */
  double stiffness_max;
  /*
   Weights of the stiffness [N/m].
   */
  const double *stiffness_weights;
  /*
   Smallest damping [N s/m].
   */
  double damping_min;
  /*
   Largest damping [N s/m].
   */
  double damping_max;
  /*
   Weights of the damping [N s/m].
   */
  const double *damping_weights;
  /*
   Virtual mass m of the second-order law m e'' + d e' + k e = f [kg]; 0: first order, d e' + k e = f.
   */
  double mass;
  /*
   Second order only: d = max(2 damping_ratio sqrt(m k), damping_floor), 1 is critical; 0: d is the damping above.
   */
  double damping_ratio;
  /*
   Least damping [N s/m] where there is a damping ratio, else 0.
   */
  double damping_floor;
} hpf_f64_axis_policy_t;

/*
 A skill: the numbers of a policy file.
 */
typedef struct hpf_f64_policy_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   Number of axes, that of the instance.
   */
  uint32_t axes;
  /*
   HPF_LISTS_...
   */
  uint32_t lists;
  /*
   Duration of the movement [s].
   */
  double duration;
  /*
   The phase falls to exp(-decay) over the duration.
   */
  double decay;
  /*
   Basis of every movement.
   */
  struct hpf_f64_basis_t movement_basis;
  /*
   Basis of every stiffness.
   */
  struct hpf_f64_basis_t stiffness_basis;
  /*
   Basis of every damping.
   */
  struct hpf_f64_basis_t damping_basis;
  /*
   The first `axes` are used.
   */
  struct hpf_f64_axis_policy_t axis[HPF_AXES_MAX];
} hpf_f64_policy_t;

/*
 Limits of one axis, applied last.
 */
typedef struct hpf_f64_limits_t {
  /*
   Largest force that enters the model [N].
   */
  double force;
  /*
   Largest offset from the reference [axis unit].
   */
  double offset;
  /*
   Largest commanded velocity [axis unit/s].
   */
  double velocity;
  /*
   Largest change of the commanded velocity [axis unit/s^2].
   */
  double acceleration;
  /*
   Smallest commanded position [axis unit].
   */
  double position_min;
  /*
   Largest commanded position [axis unit].
   */
  double position_max;
} hpf_f64_limits_t;

/*
 Settings of one axis.
 */
typedef struct hpf_f64_axis_settings_t {
  /*
   HPF_COMPLIANT, HPF_RIGID or HPF_PRESS.
   */
  uint32_t compliance;
  /*
   Set to 0.
   */
  uint32_t reserved;
  /*
   Force on the environment [N]; HPF_PRESS only.
   */
  double press;
  /*
   What a command never exceeds.
   */
  struct hpf_f64_limits_t limits;
  /*
   Compensated force above which the controller stops [N].
   */
  double trip_force;
  /*
   Distance between command and robot above which it stops [axis unit].
   */
  double tracking;
} hpf_f64_axis_settings_t;

/*
 Everything beside the skill.
 */
typedef struct hpf_f64_settings_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   The first ones, as many as the controller has axes, are used.
   */
  struct hpf_f64_axis_settings_t axis[HPF_AXES_MAX];
  /*
   Mass that hangs on the sensor [kg].
   */
  double tool_mass;
  /*
   Gravity along each axis [m/s^2].
   */
  double gravity[HPF_AXES_MAX];
  /*
   Half width of the dead zone of each axis [N].
   */
  double dead_zone[HPF_AXES_MAX];
  /*
   Cut-off of the force filter [Hz]; 0: no filter.
   */
  double cutoff;
  /*
   The most the energy tank holds [J]; 0: no tank.
   */
  double tank_capacity;
  /*
   What switching leaves in it [J].
   */
  double tank_reserve;
  /*
   Share of dissipated energy that comes back.
   */
  double tank_refill;
  /*
   The most that switching may put into one axis [W].
   */
  double tank_power;
  /*
   The most a force reading may be off, after tare, of each axis [N]; used where has_port is not 0.
   */
  double port_force_bias[HPF_AXES_MAX];
  /*
   Longest step; a longer dt is cut to it [s]. 1 us to 1 s.
   */
  double longest_step;
  /*
   Time for the rate to go from 0 to 1 or back under way [s]; a start takes none. At most 10 s.
   */
  double ramp;
  /*
   How long a bad force, measured position or rate may be bridged [s]. At most 1 s.
   */
  double hold;
  /*
   Oldest reading that is still good [steps].
   */
  uint32_t oldest_force;
  /*
   Whether the tank's energy is kept at the physical port too, by measured_position; 0: it is not.
   */
  uint32_t has_port;
  /*
   How many steps a fresh force reading may be late, 0 to 6; used where has_port is not 0.
   */
  uint32_t port_force_delay;
  /*
   Set to 0.
   */
  uint32_t reserved;
} hpf_f64_settings_t;

/*
 Why a skill or settings were refused.
 */
typedef struct hpf_error_t {
  /*
   Size of this struct; set it before the call.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION; set it before the call.
   */
  uint32_t abi_version;
  /*
   What the call returned.
   */
  int32_t status;
  /*
   Always 0.
   */
  uint32_t reserved;
  /*
   The value found, where there is one.
   */
  double value;
  /*
   The smallest value allowed, where there is one.
   */
  double min;
  /*
   The largest value allowed, where there is one.
   */
  double max;
  /*
   The parameter and what is wrong with it, ended by 0.
   */
  char text[128];
} hpf_error_t;

/*
 One step's input; of each list the first numbers, as many as the controller has axes, are used.
 */
typedef struct hpf_f64_input_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   Steps since the force was read: 0 is fresh.
   */
  uint32_t force_age;
  /*
   Whether measured_position is to be watched; 0: it is not known.
   */
  uint32_t has_position;
  /*
   HPF_START and so on, once; HPF_NO_REQUEST.
   */
  uint32_t request;
  /*
   Set to 0.
   */
  uint32_t reserved;
  /*
   Force of the environment ON the tool as the sensor reads it [N].
   */
  double measured_force[HPF_AXES_MAX];
  /*
   Position of the robot [axis unit].
   */
  double measured_position[HPF_AXES_MAX];
  /*
   Goal of HPF_GOAL, position of HPF_RESET [axis unit].
   */
  double target[HPF_AXES_MAX];
  /*
   Rate of time along the path, in [0, 1].
   */
  double rate;
} hpf_f64_input_t;

/*
 The command of one axis.
 */
typedef struct hpf_f64_axis_output_t {
  /*
   Commanded position [axis unit].
   */
  double position;
  /*
   Commanded velocity: how fast it got there from the last command [axis unit/s].
   */
  double velocity;
  /*
   Stiffness [N/m].
   */
  double stiffness;
  /*
   Damping [N s/m].
   */
  double damping;
  /*
   Offset: commanded minus reference position [axis unit].
   */
  double offset;
  /*
   Force as the model saw it, conditioned and limited [N].
   */
  double force;
  /*
   HPF_HIT_..., added.
   */
  uint32_t hits;
  /*
   Always 0.
   */
  uint32_t reserved;
} hpf_f64_axis_output_t;

/*
 One step's output.
 */
typedef struct hpf_f64_output_t {
  /*
   Size of this struct; set it before the call.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION; set it before the call.
   */
  uint32_t abi_version;
  /*
   HPF_MODE_...
   */
  uint32_t mode;
  /*
   HPF_ENDED and so on, added.
   */
  uint32_t flags;
  /*
   Phase: 1 at the start, falling.
   */
  double phase;
  /*
   Rate at which time has run along the path.
   */
  double rate;
  /*
   Energy in the tank [J]; 0 without one.
   */
  double energy;
  /*
   Energy at the physical port [J]; 0 without one.
   */
  double port_energy;
  /*
   The first ones, as many as the controller has axes, are written.
   */
  struct hpf_f64_axis_output_t axis[HPF_AXES_MAX];
} hpf_f64_output_t;

/*
 How often each has happened since the controller was made; they stop at their largest value.
 */
typedef struct hpf_counters_t {
  /*
   Size of this struct; set it before the call.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION; set it before the call.
   */
  uint32_t abi_version;
  /*
   Steps with a dt that was not finite or below 1 us.
   */
  uint32_t bad_time;
  /*
   Steps with a dt that was too long.
   */
  uint32_t long_time;
  /*
   Steps with a force that was not finite or too old.
   */
  uint32_t bad_force;
  /*
   Steps with a rate or a measured position that was not finite.
   */
  uint32_t bad_input;
  /*
   Requests and settings that the controller has refused.
   */
  uint32_t refused;
  /*
   Forces above their trip level and robots that did not follow.
   */
  uint32_t trips;
  /*
   Entries into Fault.
   */
  uint32_t faults;
  /*
   Always 0.
   */
  uint32_t reserved;
} hpf_counters_t;

/*
 A basis of 2 to HPF_BASES_MAX functions.
 */
typedef struct hpf_f32_basis_t {
  /*
   HPF_BASIS_...
   */
  uint32_t family;
  /*
   Number of functions.
   */
  uint32_t count;
  /*
   Height at which neighbours meet, in (0, 1); not used by HPF_BASIS_STORED.
   */
  float overlap;
  /*
   HPF_BASIS_STORED: centers, oldest phase first.
   */
  const float *centers;
  /*
   HPF_BASIS_STORED: widths.
   */
  const float *widths;
} hpf_f32_basis_t;

/*
 The primitives of one axis and its law; lists have one weight per function of their basis, oldest phase first.
 */
typedef struct hpf_f32_axis_policy_t {
  /*
   Where the movement starts [axis unit].
   */
  float start;
  /*
   Where it ends [axis unit].
   */
  float goal;
  /*
   Spring factor.
   */
  float alpha;
  /*
   Scale of the forcing term [axis unit].
   */
  float forcing_scale;
  /*
   Weights of the movement.
   */
  const float *movement_weights;
  /*
   Smallest stiffness [N/m].
   */
  float stiffness_min;
  /*
   Largest stiffness [N/m].
   */
  float stiffness_max;
  /*
   Weights of the stiffness [N/m].
   */
  const float *stiffness_weights;
  /*
   Smallest damping [N s/m].
   */
  float damping_min;
  /*
   Largest damping [N s/m].
   */
  float damping_max;
  /*
   Weights of the damping [N s/m].
   */
  const float *damping_weights;
  /*
   Virtual mass m of the second-order law m e'' + d e' + k e = f [kg]; 0: first order, d e' + k e = f.
   */
  float mass;
  /*
   Second order only: d = max(2 damping_ratio sqrt(m k), damping_floor), 1 is critical; 0: d is the damping above.
   */
  float damping_ratio;
  /*
   Least damping [N s/m] where there is a damping ratio, else 0.
   */
  float damping_floor;
} hpf_f32_axis_policy_t;

/*
 A skill: the numbers of a policy file.
 */
typedef struct hpf_f32_policy_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   Number of axes, that of the instance.
   */
  uint32_t axes;
  /*
   HPF_LISTS_...
   */
  uint32_t lists;
  /*
   Duration of the movement [s].
   */
  float duration;
  /*
   The phase falls to exp(-decay) over the duration.
   */
  float decay;
  /*
   Basis of every movement.
   */
  struct hpf_f32_basis_t movement_basis;
  /*
   Basis of every stiffness.
   */
  struct hpf_f32_basis_t stiffness_basis;
  /*
   Basis of every damping.
   */
  struct hpf_f32_basis_t damping_basis;
  /*
   The first `axes` are used.
   */
  struct hpf_f32_axis_policy_t axis[HPF_AXES_MAX];
} hpf_f32_policy_t;

/*
 Limits of one axis, applied last.
 */
typedef struct hpf_f32_limits_t {
  /*
   Largest force that enters the model [N].
   */
  float force;
  /*
   Largest offset from the reference [axis unit].
   */
  float offset;
  /*
   Largest commanded velocity [axis unit/s].
   */
  float velocity;
  /*
   Largest change of the commanded velocity [axis unit/s^2].
   */
  float acceleration;
  /*
   Smallest commanded position [axis unit].
   */
  float position_min;
  /*
   Largest commanded position [axis unit].
   */
  float position_max;
} hpf_f32_limits_t;

/*
 Settings of one axis.
 */
typedef struct hpf_f32_axis_settings_t {
  /*
   HPF_COMPLIANT, HPF_RIGID or HPF_PRESS.
   */
  uint32_t compliance;
  /*
   Set to 0.
   */
  uint32_t reserved;
  /*
   Force on the environment [N]; HPF_PRESS only.
   */
  float press;
  /*
   What a command never exceeds.
   */
  struct hpf_f32_limits_t limits;
  /*
   Compensated force above which the controller stops [N].
   */
  float trip_force;
  /*
   Distance between command and robot above which it stops [axis unit].
   */
  float tracking;
} hpf_f32_axis_settings_t;

/*
 Everything beside the skill.
 */
typedef struct hpf_f32_settings_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   The first ones, as many as the controller has axes, are used.
   */
  struct hpf_f32_axis_settings_t axis[HPF_AXES_MAX];
  /*
   Mass that hangs on the sensor [kg].
   */
  float tool_mass;
  /*
   Gravity along each axis [m/s^2].
   */
  float gravity[HPF_AXES_MAX];
  /*
   Half width of the dead zone of each axis [N].
   */
  float dead_zone[HPF_AXES_MAX];
  /*
   Cut-off of the force filter [Hz]; 0: no filter.
   */
  float cutoff;
  /*
   The most the energy tank holds [J]; 0: no tank.
   */
  float tank_capacity;
  /*
   What switching leaves in it [J].
   */
  float tank_reserve;
  /*
   Share of dissipated energy that comes back.
   */
  float tank_refill;
  /*
   The most that switching may put into one axis [W].
   */
  float tank_power;
  /*
   The most a force reading may be off, after tare, of each axis [N]; used where has_port is not 0.
   */
  float port_force_bias[HPF_AXES_MAX];
  /*
   Longest step; a longer dt is cut to it [s]. 1 us to 1 s.
   */
  float longest_step;
  /*
   Time for the rate to go from 0 to 1 or back under way [s]; a start takes none. At most 10 s.
   */
  float ramp;
  /*
   How long a bad force, measured position or rate may be bridged [s]. At most 1 s.
   */
  float hold;
  /*
   Oldest reading that is still good [steps].
   */
  uint32_t oldest_force;
  /*
   Whether the tank's energy is kept at the physical port too, by measured_position; 0: it is not.
   */
  uint32_t has_port;
  /*
   How many steps a fresh force reading may be late, 0 to 6; used where has_port is not 0.
   */
  uint32_t port_force_delay;
  /*
   Set to 0.
   */
  uint32_t reserved;
} hpf_f32_settings_t;

/*
 One step's input; of each list the first numbers, as many as the controller has axes, are used.
 */
typedef struct hpf_f32_input_t {
  /*
   Size of this struct.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION.
   */
  uint32_t abi_version;
  /*
   Steps since the force was read: 0 is fresh.
   */
  uint32_t force_age;
  /*
   Whether measured_position is to be watched; 0: it is not known.
   */
  uint32_t has_position;
  /*
   HPF_START and so on, once; HPF_NO_REQUEST.
   */
  uint32_t request;
  /*
   Set to 0.
   */
  uint32_t reserved;
  /*
   Force of the environment ON the tool as the sensor reads it [N].
   */
  float measured_force[HPF_AXES_MAX];
  /*
   Position of the robot [axis unit].
   */
  float measured_position[HPF_AXES_MAX];
  /*
   Goal of HPF_GOAL, position of HPF_RESET [axis unit].
   */
  float target[HPF_AXES_MAX];
  /*
   Rate of time along the path, in [0, 1].
   */
  float rate;
} hpf_f32_input_t;

/*
 The command of one axis.
 */
typedef struct hpf_f32_axis_output_t {
  /*
   Commanded position [axis unit].
   */
  float position;
  /*
   Commanded velocity: how fast it got there from the last command [axis unit/s].
   */
  float velocity;
  /*
   Stiffness [N/m].
   */
  float stiffness;
  /*
   Damping [N s/m].
   */
  float damping;
  /*
   Offset: commanded minus reference position [axis unit].
   */
  float offset;
  /*
   Force as the model saw it, conditioned and limited [N].
   */
  float force;
  /*
   HPF_HIT_..., added.
   */
  uint32_t hits;
  /*
   Always 0.
   */
  uint32_t reserved;
} hpf_f32_axis_output_t;

/*
 One step's output.
 */
typedef struct hpf_f32_output_t {
  /*
   Size of this struct; set it before the call.
   */
  uint32_t struct_size;
  /*
   HPF_ABI_VERSION; set it before the call.
   */
  uint32_t abi_version;
  /*
   HPF_MODE_...
   */
  uint32_t mode;
  /*
   HPF_ENDED and so on, added.
   */
  uint32_t flags;
  /*
   Phase: 1 at the start, falling.
   */
  float phase;
  /*
   Rate at which time has run along the path.
   */
  float rate;
  /*
   Energy in the tank [J]; 0 without one.
   */
  float energy;
  /*
   Energy at the physical port [J]; 0 without one.
   */
  float port_energy;
  /*
   The first ones, as many as the controller has axes, are written.
   */
  struct hpf_f32_axis_output_t axis[HPF_AXES_MAX];
} hpf_f32_output_t;

#ifdef __cplusplus
extern "C" {
#endif

/*
 What `status` means; never null, never freed.
 */
const char *hpf_status_text(int32_t status);

/*
 The instance for one axis in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_1(void);

/*
 The instance for two axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_2(void);

/*
 The instance for three axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_3(void);

/*
 The instance for four axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_4(void);

/*
 The instance for five axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_5(void);

/*
 The instance for six axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_6(void);

/*
 The instance for seven axes in double precision.
 */
const struct hpf_f64_instance_t *hpf_f64_axes_7(void);

/*
 The instance for `axes` in double precision, null unless there are 1 to HPF_AXES_MAX. A program that calls this links
 all of them; one that names the one it uses does not.
 */
const struct hpf_f64_instance_t *hpf_f64_instance(uint32_t axes);

/*
 Writes to `bytes` how much memory a controller of `policy` needs. Looks at axes, lists and bases only.
 */
int32_t hpf_f64_size(const struct hpf_f64_instance_t *instance, const struct hpf_f64_policy_t *policy, size_t *bytes);

/*
 Writes settings to start from: every axis gives way by the law of its policy, no filter, no tank; trips at twice the
 force limit and where the robot is off by the offset limit; steps up to 10 ms, a ramp of 0.2 s, and for 20 ms a
 bad input is bridged; a force more than 4 steps old is bad. `limits`: one per axis.
 */
int32_t hpf_f64_compliant(struct hpf_f64_settings_t *settings, uint32_t axes, const struct hpf_f64_limits_t *limits);

/*
 Makes a controller in Idle, in `bytes` of `memory` aligned to HPF_ALIGNMENT, for a robot at rest at `position` (one
 number per axis), and writes its address to `controller`; null if refused, and then `error` says why unless it is
 null. The memory stays the caller's; the controller lives until it is used otherwise, and must not be moved. No two
 threads may use one controller at once.
 */
int32_t hpf_f64_create(const struct hpf_f64_instance_t *instance,
                       void *memory,
                       size_t bytes,
                       const struct hpf_f64_policy_t *policy,
                       const struct hpf_f64_settings_t *settings,
                       const double *position,
                       struct hpf_f64_controller_t **controller,
                       struct hpf_error_t *error);

/*
 One step of `dt` [s]. Total for every number in `input`; refused, with nothing changed and nothing written, only where
 a pointer or a choice is wrong.
 */
int32_t hpf_f64_update(struct hpf_f64_controller_t *controller,
                       const struct hpf_f64_input_t *input,
                       double dt,
                       struct hpf_f64_output_t *output);

/*
 Replaces all settings between two steps, or none: the old ones then stay, and `error` says why unless it is null.
 */
int32_t hpf_f64_set(struct hpf_f64_controller_t *controller,
                    const struct hpf_f64_settings_t *settings,
                    struct hpf_error_t *error);

/*
 Writes the last output once more.
 */
int32_t hpf_f64_output(const struct hpf_f64_controller_t *controller, struct hpf_f64_output_t *output);

/*
 Writes how often what has gone wrong.
 */
int32_t hpf_f64_counters(const struct hpf_f64_controller_t *controller, struct hpf_counters_t *counters);

/*
 Writes to `bias` (one number per axis) the force that is called zero, beside the tool's weight: what the last tare has
 found [N].
 */
int32_t hpf_f64_bias(const struct hpf_f64_controller_t *controller, double *bias);

/*
 The instance for one axis in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_1(void);

/*
 The instance for two axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_2(void);

/*
 The instance for three axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_3(void);

/*
 The instance for four axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_4(void);

/*
 The instance for five axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_5(void);

/*
 The instance for six axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_6(void);

/*
 The instance for seven axes in single precision.
 */
const struct hpf_f32_instance_t *hpf_f32_axes_7(void);

/*
 The instance for `axes` in single precision, null unless there are 1 to HPF_AXES_MAX. A program that calls this links
 all of them; one that names the one it uses does not.
 */
const struct hpf_f32_instance_t *hpf_f32_instance(uint32_t axes);

/*
 Writes to `bytes` how much memory a controller of `policy` needs. Looks at axes, lists and bases only.
 */
int32_t hpf_f32_size(const struct hpf_f32_instance_t *instance, const struct hpf_f32_policy_t *policy, size_t *bytes);

/*
 Writes settings to start from: every axis gives way by the law of its policy, no filter, no tank; trips at twice the
 force limit and where the robot is off by the offset limit; steps up to 10 ms, a ramp of 0.2 s, and for 20 ms a
 bad input is bridged; a force more than 4 steps old is bad. `limits`: one per axis.
 */
int32_t hpf_f32_compliant(struct hpf_f32_settings_t *settings, uint32_t axes, const struct hpf_f32_limits_t *limits);

/*
 Makes a controller in Idle, in `bytes` of `memory` aligned to HPF_ALIGNMENT, for a robot at rest at `position` (one
 number per axis), and writes its address to `controller`; null if refused, and then `error` says why unless it is
 null. The memory stays the caller's; the controller lives until it is used otherwise, and must not be moved. No two
 threads may use one controller at once.
 */
int32_t hpf_f32_create(const struct hpf_f32_instance_t *instance,
                       void *memory,
                       size_t bytes,
                       const struct hpf_f32_policy_t *policy,
                       const struct hpf_f32_settings_t *settings,
                       const float *position,
                       struct hpf_f32_controller_t **controller,
                       struct hpf_error_t *error);

/*
 One step of `dt` [s]. Total for every number in `input`; refused, with nothing changed and nothing written, only where
 a pointer or a choice is wrong.
 */
int32_t hpf_f32_update(struct hpf_f32_controller_t *controller,
                       const struct hpf_f32_input_t *input,
                       float dt,
                       struct hpf_f32_output_t *output);

/*
 Replaces all settings between two steps, or none: the old ones then stay, and `error` says why unless it is null.
 */
int32_t hpf_f32_set(struct hpf_f32_controller_t *controller,
                    const struct hpf_f32_settings_t *settings,
                    struct hpf_error_t *error);

/*
 Writes the last output once more.
 */
int32_t hpf_f32_output(const struct hpf_f32_controller_t *controller, struct hpf_f32_output_t *output);

/*
 Writes how often what has gone wrong.
 */
int32_t hpf_f32_counters(const struct hpf_f32_controller_t *controller, struct hpf_counters_t *counters);

/*
 Writes to `bias` (one number per axis) the force that is called zero, beside the tool's weight: what the last tare has
 found [N].
 */
int32_t hpf_f32_bias(const struct hpf_f32_controller_t *controller, float *bias);

#ifdef __cplusplus
}
#endif

#endif  /* HPF_H */
