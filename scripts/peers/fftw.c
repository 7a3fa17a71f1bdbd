/* How long FFTW takes for a real transform forward and backward, with measured plans: prints a JSON line a case.
 *
 *   cc -O3 -march=native scripts/peers/fftw.c -o fftw -lfftw3 -lfftw3_threads -lfftw3f -lfftw3f_threads -lm -lpthread
 *   ./fftw [SECONDS] [THREADS] SIZE...
 *
 * transform_ms: r2c and c2r of one component, in place, the faster of that and out of place; three_ms: of three
 * components, as one plan of three.
 */
#include <fftw3.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

enum { LONGEST = 100000 };
static double times[LONGEST];

/* Defines NAME(size, components, in_place, seconds): the median time of one forward and backward transform. */
#define MEDIAN(NAME, REAL, FFTW)                                                                                       \
    static double NAME(int n, int components, int in_place, double seconds) {                                          \
        int points[3] = {n, n, n}, padded[3] = {n, n, 2 * (n / 2 + 1)}, spectral[3] = {n, n, n / 2 + 1};                 \
        size_t reals = (size_t)n * n * padded[2], modes = reals / 2;                                                   \
        REAL *values = FFTW##_malloc(sizeof(REAL) * reals * components);                                               \
        FFTW##_complex *spectrum = in_place ? (void *)values : FFTW##_malloc(sizeof(FFTW##_complex) * modes * components); \
        int *real_shape = in_place ? padded : points;                                                                  \
        int real_distance = in_place ? (int)reals : n * n * n;                                                         \
        FFTW##_plan forward = FFTW##_plan_many_dft_r2c(3, points, components, values, real_shape, 1, real_distance,   \
                                                       spectrum, spectral, 1, (int)modes, FFTW_MEASURE);              \
        FFTW##_plan backward = FFTW##_plan_many_dft_c2r(3, points, components, spectrum, spectral, 1, (int)modes,     \
                                                        values, real_shape, 1, real_distance, FFTW_MEASURE);          \
        for (size_t i = 0; i < reals * components; i++) values[i] = 0;                                                 \
        int count = 0;                                                                                                 \
        double start = now();                                                                                          \
        while (count < LONGEST && (count < 4 || now() - start < seconds)) {                                            \
            double begin = now();                                                                                      \
            FFTW##_execute(forward);                                                                                   \
            FFTW##_execute(backward);                                                                                  \
            times[count++] = now() - begin;                                                                            \
        }                                                                                                              \
        FFTW##_destroy_plan(forward);                                                                                  \
        FFTW##_destroy_plan(backward);                                                                                 \
        FFTW##_free(values);                                                                                           \
        if (!in_place) FFTW##_free(spectrum);                                                                          \
        qsort(times, count, sizeof(double), ascending);                                                                \
        return times[count / 2];                                                                                       \
    }

MEDIAN(median_f64, double, fftw)
MEDIAN(median_f32, float, fftwf)

static void report(int n, const char *precision, int threads, double seconds,
                   double (*median)(int, int, int, double)) {
    double best[2];
    for (int many = 0; many < 2; many++) {
        double a = median(n, many ? 3 : 1, 0, seconds), b = median(n, many ? 3 : 1, 1, seconds);
        best[many] = a < b ? a : b;
    }
    printf("{\"program\": \"fftw\", \"size\": %d, \"precision\": \"%s\", \"threads\": %d, \"transform_ms\": %.3f, "
           "\"three_ms\": %.3f}\n", n, precision, threads, 1e3 * best[0], 1e3 * best[1]);
    fflush(stdout);
}

int main(int count, char **arguments) {
    double seconds = count > 1 ? atof(arguments[1]) : 1;
    int threads = count > 2 ? atoi(arguments[2]) : 1;
    fftw_init_threads();
    fftwf_init_threads();
    fftw_plan_with_nthreads(threads);
    fftwf_plan_with_nthreads(threads);
    for (int i = 3; i < count; i++) {
        report(atoi(arguments[i]), "f64", threads, seconds, median_f64);
        report(atoi(arguments[i]), "f32", threads, seconds, median_f32);
    }
    return 0;
}
