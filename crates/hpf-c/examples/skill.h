/*
 * Skill `reach`, made by `hpf export` 0.1.0: not edited by hand.
 *
 * Axis 0: `x`, in m, N, N/m, N s/m.
 * Basis functions psi_i(s) = exp(-h_i (s - c_i)^2) of the phase s = exp(-decay t/duration), centers c_i, widths h_i.
 * Admittance: first order, d e' + k e = f.
 * Policy: SHA-256 234fce99a85855a876f03b8acd6396216b941e3799ee3e544b4d1c5a926e3099.
 * Learned: hpf 0.1.0, seed 1, 0 updates, cost 0.0.
 */
#ifndef HPF_REACH_H
#define HPF_REACH_H

/* Number of axes. */
#define HPF_REACH_AXES 1
/* Functions in the basis of movement. */
#define HPF_REACH_MOVEMENT_BASIS 20
/* Functions in the basis of stiffness. */
#define HPF_REACH_STIFFNESS_BASIS 20
/* Functions in the basis of damping. */
#define HPF_REACH_DAMPING_BASIS 20

/* Names of the axes. */
static const char *const hpf_reach_names[HPF_REACH_AXES] = {
    "x",
};

/* Duration of the movement [s]. */
static const double hpf_reach_duration = 1.0;
/* Decay alpha_s of the phase over the duration. */
static const double hpf_reach_decay = 4.605170185988092;

/* Where the movement starts [m or rad], by axis. */
static const double hpf_reach_start[HPF_REACH_AXES] = {
    0.0,
};

/* Where it ends [m or rad], by axis. */
static const double hpf_reach_goal[HPF_REACH_AXES] = {
    0.3,
};

/* Spring factor alpha of the movement; beta = alpha/4, by axis. */
static const double hpf_reach_alpha[HPF_REACH_AXES] = {
    25.0,
};

/* Scale A of the forcing term [m or rad], by axis. */
static const double hpf_reach_forcing_scale[HPF_REACH_AXES] = {
    0.3,
};

/* Least stiffness [N/m or N m/rad], by axis. */
static const double hpf_reach_stiffness_min[HPF_REACH_AXES] = {
    30.0,
};

/* Largest stiffness [N/m or N m/rad], by axis. */
static const double hpf_reach_stiffness_max[HPF_REACH_AXES] = {
    400.0,
};

/* Least damping [N s/m or N m s/rad], by axis. */
static const double hpf_reach_damping_min[HPF_REACH_AXES] = {
    10.0,
};

/* Largest damping [N s/m or N m s/rad], by axis. */
static const double hpf_reach_damping_max[HPF_REACH_AXES] = {
    100.0,
};

/* Virtual mass of the admittance of second order [kg or kg m^2], 0: first order, by axis. */
static const double hpf_reach_mass[HPF_REACH_AXES] = {
    0.0,
};

/* Centers of the basis of movement, oldest phase first. */
static const double hpf_reach_movement_centers[HPF_REACH_MOVEMENT_BASIS] = {
    1.0, 0.7847599703514613, 0.6158482110660264, 0.48329302385717526, 0.3792690190732249,
    0.29763514416313175, 0.23357214690901218, 0.18329807108324359, 0.14384498882876626, 0.11288378916846886,
    0.08858667904100823, 0.06951927961775604, 0.05455594781168517, 0.04281332398719392, 0.03359818286283781,
    0.026366508987303562, 0.020691380811147887, 0.016237767391887217, 0.012742749857031329,
    0.009999999999999995,
};
/* Widths of the basis of movement. */
static const double hpf_reach_movement_widths[HPF_REACH_MOVEMENT_BASIS] = {
    11.026218327650236, 17.904116841654822, 29.07228846319611, 47.20690576152253, 76.6534755046343,
    124.4681305023978, 202.10845508009996, 328.1790081524341, 532.8894397279483, 865.2934767895542,
    1405.0434201826167, 2281.4768232426923, 3704.608996579664, 6015.457916435347, 9767.760640276312,
    15860.662521643926, 25754.17487076774, 41819.030092151006, 67904.7683190685, 67904.7683190685,
};

/* Centers of the basis of stiffness, oldest phase first. */
static const double hpf_reach_stiffness_centers[HPF_REACH_STIFFNESS_BASIS] = {
    1.0, 0.7847599703514613, 0.6158482110660264, 0.48329302385717526, 0.3792690190732249,
    0.29763514416313175, 0.23357214690901218, 0.18329807108324359, 0.14384498882876626, 0.11288378916846886,
    0.08858667904100823, 0.06951927961775604, 0.05455594781168517, 0.04281332398719392, 0.03359818286283781,
    0.026366508987303562, 0.020691380811147887, 0.016237767391887217, 0.012742749857031329,
    0.009999999999999995,
};
/* Widths of the basis of stiffness. */
static const double hpf_reach_stiffness_widths[HPF_REACH_STIFFNESS_BASIS] = {
    11.026218327650236, 17.904116841654822, 29.07228846319611, 47.20690576152253, 76.6534755046343,
    124.4681305023978, 202.10845508009996, 328.1790081524341, 532.8894397279483, 865.2934767895542,
    1405.0434201826167, 2281.4768232426923, 3704.608996579664, 6015.457916435347, 9767.760640276312,
    15860.662521643926, 25754.17487076774, 41819.030092151006, 67904.7683190685, 67904.7683190685,
};

/* Centers of the basis of damping, oldest phase first. */
static const double hpf_reach_damping_centers[HPF_REACH_DAMPING_BASIS] = {
    1.0, 0.7847599703514613, 0.6158482110660264, 0.48329302385717526, 0.3792690190732249,
    0.29763514416313175, 0.23357214690901218, 0.18329807108324359, 0.14384498882876626, 0.11288378916846886,
    0.08858667904100823, 0.06951927961775604, 0.05455594781168517, 0.04281332398719392, 0.03359818286283781,
    0.026366508987303562, 0.020691380811147887, 0.016237767391887217, 0.012742749857031329,
    0.009999999999999995,
};
/* Widths of the basis of damping. */
static const double hpf_reach_damping_widths[HPF_REACH_DAMPING_BASIS] = {
    11.026218327650236, 17.904116841654822, 29.07228846319611, 47.20690576152253, 76.6534755046343,
    124.4681305023978, 202.10845508009996, 328.1790081524341, 532.8894397279483, 865.2934767895542,
    1405.0434201826167, 2281.4768232426923, 3704.608996579664, 6015.457916435347, 9767.760640276312,
    15860.662521643926, 25754.17487076774, 41819.030092151006, 67904.7683190685, 67904.7683190685,
};

/* Weights of movement [1], by axis. */
static const double hpf_reach_movement_weights[HPF_REACH_AXES][HPF_REACH_MOVEMENT_BASIS] = {
    {
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    },
};

/* Weights of stiffness [N/m or N m/rad], by axis. */
static const double hpf_reach_stiffness_weights[HPF_REACH_AXES][HPF_REACH_STIFFNESS_BASIS] = {
    {
        100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0, 100.0,
        100.0, 100.0, 100.0, 100.0, 100.0, 100.0,
    },
};

/* Weights of damping [N s/m or N m s/rad], by axis. */
static const double hpf_reach_damping_weights[HPF_REACH_AXES][HPF_REACH_DAMPING_BASIS] = {
    {
        50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0, 50.0,
        50.0, 50.0, 50.0,
    },
};

/* Numbers of HPF_F64_BYTES for this skill, its lists used where they are. */
#define HPF_REACH_NUMBERS 120
/* Fills a hpf_f64_policy_t of hpf.h, to be included before: HPF_REACH_POLICY(policy); */
#define HPF_REACH_POLICY(policy) \
  do { \
    HPF_PREPARE(policy); \
    (policy).axes = HPF_REACH_AXES; \
    (policy).lists = HPF_LISTS_BORROWED; \
    (policy).duration = hpf_reach_duration; \
    (policy).decay = hpf_reach_decay; \
    (policy).movement_basis.count = HPF_REACH_MOVEMENT_BASIS; \
    (policy).movement_basis.family = HPF_BASIS_STORED; \
    (policy).movement_basis.centers = hpf_reach_movement_centers; \
    (policy).movement_basis.widths = hpf_reach_movement_widths; \
    (policy).stiffness_basis.count = HPF_REACH_STIFFNESS_BASIS; \
    (policy).stiffness_basis.family = HPF_BASIS_STORED; \
    (policy).stiffness_basis.centers = hpf_reach_stiffness_centers; \
    (policy).stiffness_basis.widths = hpf_reach_stiffness_widths; \
    (policy).damping_basis.count = HPF_REACH_DAMPING_BASIS; \
    (policy).damping_basis.family = HPF_BASIS_STORED; \
    (policy).damping_basis.centers = hpf_reach_damping_centers; \
    (policy).damping_basis.widths = hpf_reach_damping_widths; \
    (policy).axis[0].start = hpf_reach_start[0]; \
    (policy).axis[0].goal = hpf_reach_goal[0]; \
    (policy).axis[0].alpha = hpf_reach_alpha[0]; \
    (policy).axis[0].forcing_scale = hpf_reach_forcing_scale[0]; \
    (policy).axis[0].stiffness_min = hpf_reach_stiffness_min[0]; \
    (policy).axis[0].stiffness_max = hpf_reach_stiffness_max[0]; \
    (policy).axis[0].damping_min = hpf_reach_damping_min[0]; \
    (policy).axis[0].damping_max = hpf_reach_damping_max[0]; \
    (policy).axis[0].mass = hpf_reach_mass[0]; \
    (policy).axis[0].movement_weights = hpf_reach_movement_weights[0]; \
    (policy).axis[0].stiffness_weights = hpf_reach_stiffness_weights[0]; \
    (policy).axis[0].damping_weights = hpf_reach_damping_weights[0]; \
  } while (0)

#endif
