/* Calls everything the proof exports, so that the linker must keep it, and checks that it works. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

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

int main(void) {
    bool single = try_f32(), twice = try_f64();
    return single && twice ? 0 : 1;
}
