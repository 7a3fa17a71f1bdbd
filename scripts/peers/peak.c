/* What one core can do at most: fused multiplications and additions on vectors that stay in registers. Prints a JSON line for
 * each precision.
 *
 *   cc -O3 -march=native scripts/peers/peak.c -o peak && ./peak
 */
#include <stdio.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

enum { SUMS = 12, STEPS = 2000000, REPEATS = 20 };

/* Defines NAME(): the most floating-point operations a second of a few repetitions. */
#define PEAK(NAME, REAL)                                                                                               \
    typedef REAL NAME##_vector __attribute__((vector_size(64)));                                                       \
    static double NAME(void) {                                                                                         \
        double best = 0.0;                                                                                             \
        for (int repeat = 0; repeat < REPEATS; repeat++) {                                                             \
            NAME##_vector sums[SUMS], factor = (NAME##_vector){} + (REAL)0.999999, term = (NAME##_vector){} + (REAL)1e-6; \
            for (int i = 0; i < SUMS; i++) sums[i] = (NAME##_vector){} + (REAL)i;                                      \
            double start = now();                                                                                      \
            for (long step = 0; step < STEPS; step++)                                                                  \
                for (int i = 0; i < SUMS; i++) sums[i] = sums[i] * factor + term;                                      \
            double seconds = now() - start;                                                                            \
            for (int i = 0; i < SUMS; i++) __asm__ volatile("" : : "x"(sums[i]));                                      \
            double rate = 2.0 * SUMS * STEPS * (64 / sizeof(REAL)) / seconds;                                          \
            if (rate > best) best = rate;                                                                              \
        }                                                                                                              \
        return best;                                                                                                   \
    }

PEAK(single, float)
PEAK(twofold, double)

int main(void) {
    printf("{\"precision\": \"f32\", \"flops\": %.4g}\n", single());
    printf("{\"precision\": \"f64\", \"flops\": %.4g}\n", twofold());
    return 0;
}
