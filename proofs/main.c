/* Calls everything the proof exports, so that the linker must keep it, and checks that it works. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { N = 20, D = 2, ROOM = 8192 };

#define TRY(T)                                                                                              \
    bool hpf_##T##_new(void *run, const T weights[3][D][N], const T goal[D], T duration, T decay);          \
    void hpf_##T##_step(void *run, const T force[D], T rate, T dt, T commands[D][4]);                       \
    void hpf_##T##_update(void *run, const T force[D], unsigned request, T rate, T dt, T commands[D][4]);   \
                                                                                                            \
    static bool try_##T(void) {                                                                             \
        static _Alignas(8) unsigned char run[ROOM];                                                         \
        static T weights[3][D][N];                                                                          \
        const T goal[D] = {1, -0.5}, push[D] = {20, 0}, bad[D] = {NAN, INFINITY};                           \
        T commands[D][4];                                                                                   \
        if (hpf_##T##_new(run, weights, goal, 1, 4.6)) return false; /* a stiffness of 0 is refused */      \
        for (int axis = 0; axis < D; axis++)                                                                \
            for (int i = 0; i < N; i++) weights[1][axis][i] = 100, weights[2][axis][i] = 50;                \
        if (!hpf_##T##_new(run, weights, goal, 1, 4.6)) return false;                                       \
        for (int i = 0; i < 5000; i++) hpf_##T##_step(run, i % 100 ? push : bad, 1, 0.001, commands);       \
        printf("  %s: x = %.4f m (1 + 20/100), y = %.4f m after 5 s\n", #T, (double)commands[0][0],         \
               (double)commands[1][0]);                                                                     \
        if (!(fabs(commands[0][0] - 1.2) < 1e-3 && fabs(commands[1][0] + 0.5) < 1e-3)) return false;        \
        for (int i = 0; i < 5000; i++)                                                                      \
            hpf_##T##_update(run, (i + 1) % 100 ? push : bad, i == 0, 1, 0.001, commands);                        \
        printf("  %s: x = %.4f m, y = %.4f m under a controller\n", #T, (double)commands[0][0],             \
               (double)commands[1][0]);                                                                     \
        return fabs(commands[0][0] - 1.2) < 1e-3 && fabs(commands[1][0] + 0.5) < 1e-3;                      \
    }

typedef float f32;
typedef double f64;
TRY(f32)
TRY(f64)

bool hpf_f32_unpack(const uint8_t *bytes, size_t length, f32 position[2]);
bool hpf_f64_unpack(const uint8_t *bytes, size_t length, f64 position[2]);

static uint8_t packed[4096];
static size_t length;

static void put(const void *bytes, size_t count) {
    memcpy(packed + length, bytes, count);
    length += count;
}

static void number(f64 value) { put(&value, sizeof value); }

static void list(f64 first, f64 step) {
    for (int i = 0; i < N; i++) number(first + step * i);
}

/* Packs a skill on a little-endian machine, reads it whole, then with each byte damaged. */
static bool try_unpack(void) {
    const uint8_t head[16] = {'H', 'P', 'F', 'S', 2, 0, 8, D, N, 0, N, 0, N, 0, 0, 0};
    put(head, sizeof head);
    number(1), number(4.6);
    for (int basis = 0; basis < 3; basis++) list(1, -0.04), list(50, 1);
    for (int axis = 0; axis < D; axis++) {
        number(0), number(1), number(25), number(1), list(0, 1);
        number(30), number(400), list(100, 5);
        number(10), number(100), list(50, 1);
        number(axis ? 2 : 0), number(axis ? 1 : 0), number(axis ? 10 : 0);
    }
    uint32_t sum = UINT32_MAX;
    for (size_t i = 0; i < length; i++) {
        sum ^= packed[i];
        for (int bit = 0; bit < 8; bit++) sum = (sum >> 1) ^ (sum & 1 ? 0xEDB88320u : 0);
    }
    sum = ~sum;
    put(&sum, sizeof sum);
    f64 twice[2] = {0, 1};
    f32 single[2] = {0, 1};
    if (!hpf_f64_unpack(packed, length, twice) || !hpf_f32_unpack(packed, length, single)) return false;
    printf("  packed: x = %.6f m after a step, %zu bytes\n", twice[0], length);
    bool same = twice[0] == twice[1] && single[0] == single[1] && fabs(twice[0] - single[0]) < 1e-6;
    for (size_t i = 0; i < length; i++) {
        packed[i] ^= 0x40;
        same = same && !hpf_f64_unpack(packed, length, twice) && !hpf_f64_unpack(packed, i, twice);
        packed[i] ^= 0x40;
    }
    return same;
}

bool hpf_f32_pose(const f32 input[13], f32 dt, f32 out[8]);
bool hpf_f64_pose(const f64 input[13], f64 dt, f64 out[8]);

/* A step of orientation in both precisions, the quaternion of norm 1; four numbers that are no rotation are refused. */
static bool try_pose(void) {
    f64 input[13] = {0.5, 0.5, -0.5, 0.5, 0.1, -0.2, 0.3, 1, -2, 0.5, 0.2, 0.1, -0.3}, out[8], norm = 0, gap = 0;
    f32 narrow[13], narrow_out[8];
    for (int i = 0; i < 13; i++) narrow[i] = (f32)input[i];
    if (!hpf_f64_pose(input, 0.001, out) || !hpf_f32_pose(narrow, 0.001F, narrow_out)) return false;
    for (int i = 0; i < 4; i++) norm += out[i] * out[i];
    for (int i = 0; i < 8; i++) gap = fmax(gap, fabs(out[i] - (f64)narrow_out[i]));
    printf("  pose: w = %.6f after a step, single precision within %.0e\n", out[0], gap);
    input[0] = 0.6;
    return fabs(norm - 1) < 1e-14 && gap < 1e-5 && !hpf_f64_pose(input, 0.001, out);
}

int main(void) {
    bool single = try_f32(), twice = try_f64();
    return single && twice && try_unpack() && try_pose() ? 0 : 1;
}
