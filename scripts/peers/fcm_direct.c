/* The force-coupling method as textbooks have it: Gaussian envelopes of forces and force dipoles on a periodic grid, FFTW
 * in all three directions, and no further idea. A plain program to measure against.
 *
 *   cc -O3 -march=native -ffast-math -fopenmp scripts/peers/fcm_direct.c -o fcm_direct -lfftw3_omp -lfftw3 -lm
 *   ./fcm_direct PARTICLES VOLUME_FRACTION GRID SUPPORT REPEATS
 *
 * Unit spheres at random in a cube, viscosity 1; one mobility: forces F and couplets G (9 numbers, traceless) to
 * velocities V and gradients of velocity D. OMP_NUM_THREADS sets the threads. Prints a JSON line: median seconds of each
 * stage over the repeats, and the largest relative 2-norm of the errors of V and D, against a grid half as fine again
 * and the widest support.
 */
#include <fftw3.h>
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDEST = 48, STAGES = 5 };
enum { SPREAD, FFT, SOLVE, INTERPOLATE, TOTAL };

typedef struct {
    int count;
    double edge;
    double *position, *force, *couplet;   /* 3, 3 and 9 numbers a particle */
    double *velocity, *gradient;          /* 3 and 9 */
} Particles;

typedef struct {
    int points, support;
    size_t row, plane, component;         /* distances in the field, in numbers */
    double spacing, *field;               /* three components, [x][y][z], rows padded for the transform in place */
    fftw_plan forward, backward;
} Grid;

/* The points near one particle: their indices, distances from its centre and Gaussians, along each axis. */
typedef struct {
    int index[3][WIDEST];
    double distance[3][WIDEST], monopole[3][WIDEST], dipole[3][WIDEST];
    int is_whole;                         /* the row along z does not wrap around */
} Stencil;

static double monopole_width(void) { return 1 / sqrt(M_PI); }
static double dipole_width(void) { return 1 / cbrt(6 * sqrt(M_PI)); }

static void *numbers(size_t count) {
    double *list = fftw_alloc_real(count);
    if (!list) { fprintf(stderr, "out of memory\n"); exit(1); }
    memset(list, 0, count * sizeof *list);
    return list;
}

static double gaussian(double x, double width) { return exp(-x * x / (2 * width * width)) / (sqrt(2 * M_PI) * width); }

static int by_plane(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static Particles random_particles(int count, double fraction) {
    Particles p = {.count = count, .edge = cbrt(count * 4 * M_PI / 3 / fraction)};
    p.position = numbers(3 * count), p.force = numbers(3 * count), p.couplet = numbers(9 * count);
    p.velocity = numbers(3 * count), p.gradient = numbers(9 * count);
    srand48(1);
    for (int i = 0; i < 3 * count; i++) p.position[i] = drand48() * p.edge, p.force[i] = drand48() - 0.5;
    for (int i = 0; i < 9 * count; i++) p.couplet[i] = drand48() - 0.5;
    for (double *g = p.couplet; g < p.couplet + 9 * count; g += 9) {
        double third = (g[0] + g[4] + g[8]) / 3;
        g[0] -= third, g[4] -= third, g[8] -= third;
    }
    qsort(p.position, count, 3 * sizeof(double), by_plane);   /* neighbours in memory are neighbours in space */
    return p;
}

static Grid plan(int points, int support, double edge, unsigned effort) {
    Grid g = {.points = points, .support = support, .row = 2 * (points / 2 + 1), .spacing = edge / points};
    g.plane = g.row * points, g.component = g.plane * points;
    g.field = numbers(3 * g.component);
    int n[3] = {points, points, points}, half = g.component / 2;
    fftw_complex *spectrum = (fftw_complex *)g.field;
    fftw_plan_with_nthreads(omp_get_max_threads());
    g.forward = fftw_plan_many_dft_r2c(3, n, 3, g.field, 0, 1, g.component, spectrum, 0, 1, half, effort);
    g.backward = fftw_plan_many_dft_c2r(3, n, 3, spectrum, 0, 1, half, g.field, 0, 1, g.component, effort);
    return g;
}

static void drop(Grid *g) {
    fftw_destroy_plan(g->forward), fftw_destroy_plan(g->backward), fftw_free(g->field);
}

/* Loops over a stencil whose width the compiler knows, so that rows stay in registers. */
#define ALWAYS static inline __attribute__((always_inline))
#define FOR_SUPPORT(support, call)                                                                                     \
    switch (support) {                                                                                                 \
    case 8: { enum { P = 8 }; call; } break;                                                                           \
    case 10: { enum { P = 10 }; call; } break;                                                                         \
    case 12: { enum { P = 12 }; call; } break;                                                                         \
    case 14: { enum { P = 14 }; call; } break;                                                                         \
    case 16: { enum { P = 16 }; call; } break;                                                                         \
    case 18: { enum { P = 18 }; call; } break;                                                                         \
    case 20: { enum { P = 20 }; call; } break;                                                                         \
    case 22: { enum { P = 22 }; call; } break;                                                                         \
    default: { int P = support; call; }                                                                                \
    }

static int first_point(const Grid *g, double x) { return (int)floor(x / g->spacing) - (g->support / 2 - 1); }

static int wrapped(const Grid *g, int i) { return (i % g->points + g->points) % g->points; }

static void find(Stencil *s, const Grid *g, const double *centre) {
    for (int axis = 0; axis < 3; axis++) {
        int first = first_point(g, centre[axis]);
        for (int j = 0; j < g->support; j++) {
            double x = (first + j) * g->spacing - centre[axis];
            s->index[axis][j] = wrapped(g, first + j);
            s->distance[axis][j] = x;
            s->monopole[axis][j] = gaussian(x, monopole_width());
            s->dipole[axis][j] = gaussian(x, dipole_width());
        }
    }
    s->is_whole = s->index[2][0] + g->support <= g->points;
}

/* Adds the row along z at jx, jy: all three components at once. */
ALWAYS void add_row(const Grid *g, const Stencil *s, const double *F, const double *G, int jx, int jy, const int P) {
    const double slope = -1 / (dipole_width() * dipole_width());
    double monopole = s->monopole[0][jx] * s->monopole[1][jy];
    double dipole = slope * s->dipole[0][jx] * s->dipole[1][jy];
    double X = s->distance[0][jx], Y = s->distance[1][jy], value[3][WIDEST];
    double Gx = G[0] * X + G[1] * Y, Gy = G[3] * X + G[4] * Y, Gz = G[6] * X + G[7] * Y;
#pragma omp simd
    for (int j = 0; j < P; j++) {
        double m = monopole * s->monopole[2][j], d = dipole * s->dipole[2][j], z = s->distance[2][j];
        value[0][j] = F[0] * m + (Gx + G[2] * z) * d;
        value[1][j] = F[1] * m + (Gy + G[5] * z) * d;
        value[2][j] = F[2] * m + (Gz + G[8] * z) * d;
    }
    double *row = g->field + s->index[0][jx] * g->plane + s->index[1][jy] * g->row;
    for (int c = 0; c < 3; c++) {
        double *into = row + c * g->component;
        if (s->is_whole) {
            into += s->index[2][0];
#pragma omp simd
            for (int j = 0; j < P; j++) into[j] += value[c][j];
        } else {
            for (int j = 0; j < P; j++) into[s->index[2][j]] += value[c][j];
        }
    }
}

ALWAYS void spread_one(const Grid *g, const Particles *p, int i, int from, int to, const int P) {
    Stencil s;
    find(&s, g, p->position + 3 * i);
    for (int jx = 0; jx < P; jx++)
        if (s.index[0][jx] >= from && s.index[0][jx] < to)
            for (int jy = 0; jy < P; jy++) add_row(g, &s, p->force + 3 * i, p->couplet + 9 * i, jx, jy, P);
}

/* f_i = F_i Delta + G_ij d_j Delta', with d_j Delta' = -x_j / width^2 Delta'. Each thread fills the planes it owns. */
static void spread(Grid *g, const Particles *p) {
#pragma omp parallel
    {
        int threads = omp_get_num_threads(), thread = omp_get_thread_num(), support = g->support;
        int from = g->points * thread / threads, to = g->points * (thread + 1) / threads;
        for (int c = 0; c < 3; c++) memset(g->field + c * g->component + from * g->plane, 0, (to - from) * g->plane * sizeof(double));
        for (int i = 0; i < p->count; i++) {
            int first = first_point(g, p->position[3 * i]), mine = 0;
            for (int j = 0; j < support; j++) {
                int x = wrapped(g, first + j);
                mine |= x >= from && x < to;
            }
            if (mine) FOR_SUPPORT(support, spread_one(g, p, i, from, to, P))
        }
    }
}

/* u = (I - k k / k^2) f / k^2, and no mean flow. */
static void solve(Grid *g, double edge) {
    int n = g->points;
    double unit = 2 * M_PI / edge, scale = 1 / ((double)n * n * n);
#pragma omp parallel for
    for (int x = 0; x < n; x++) {
        double kx = unit * (x <= n / 2 ? x : x - n);
        for (int y = 0; y < n; y++) {
            double ky = unit * (y <= n / 2 ? y : y - n), *u = g->field + x * g->plane + y * g->row;
            double *v = u + g->component, *w = v + g->component;
            for (size_t i = 0; i < g->row; i++) {   /* real and imaginary parts in turn */
                double kz = unit * (i / 2), square = kx * kx + ky * ky + kz * kz;
                double inverse = square > 0 ? 1 / square : 0;
                double along = (kx * u[i] + ky * v[i] + kz * w[i]) * inverse, factor = inverse * scale;
                u[i] = (u[i] - kx * along) * factor;
                v[i] = (v[i] - ky * along) * factor;
                w[i] = (w[i] - kz * along) * factor;
            }
        }
    }
}

/* Sums over the row along z at jx, jy of all three components: V, and D by its columns. */
ALWAYS void sum_row(const Grid *g, const Stencil *s, int jx, int jy, double *V, double *D, const int P) {
    double monopole = s->monopole[0][jx] * s->monopole[1][jy], dipole = s->dipole[0][jx] * s->dipole[1][jy];
    const double *row = g->field + s->index[0][jx] * g->plane + s->index[1][jy] * g->row;
    double u[3][WIDEST];
    for (int c = 0; c < 3; c++) {
        const double *from = row + c * g->component;
        if (s->is_whole)
            memcpy(u[c], from + s->index[2][0], P * sizeof **u);
        else
            for (int j = 0; j < P; j++) u[c][j] = from[s->index[2][j]];
    }
    double a0 = 0, a1 = 0, a2 = 0, b0 = 0, b1 = 0, b2 = 0, c0 = 0, c1 = 0, c2 = 0;
#pragma omp simd reduction(+ : a0, a1, a2, b0, b1, b2, c0, c1, c2)
    for (int j = 0; j < P; j++) {
        double m = monopole * s->monopole[2][j], d = dipole * s->dipole[2][j], dz = d * s->distance[2][j];
        a0 += u[0][j] * m, a1 += u[1][j] * m, a2 += u[2][j] * m;
        b0 += u[0][j] * d, b1 += u[1][j] * d, b2 += u[2][j] * d;
        c0 += u[0][j] * dz, c1 += u[1][j] * dz, c2 += u[2][j] * dz;
    }
    double X = s->distance[0][jx], Y = s->distance[1][jy];
    V[0] += a0, V[1] += a1, V[2] += a2;
    D[0] += b0 * X, D[1] += b0 * Y, D[2] += c0;
    D[3] += b1 * X, D[4] += b1 * Y, D[5] += c1;
    D[6] += b2 * X, D[7] += b2 * Y, D[8] += c2;
}

ALWAYS void interpolate_one(const Grid *g, const Particles *p, int i, double *V, double *D, const int P) {
    Stencil s;
    find(&s, g, p->position + 3 * i);
    for (int jx = 0; jx < P; jx++)
        for (int jy = 0; jy < P; jy++) sum_row(g, &s, jx, jy, V, D, P);
}

/* V = integral of u Delta, D_ij = integral of d_j u_i Delta' = - integral of u_i d_j Delta'. */
static void interpolate(const Grid *g, const Particles *p) {
    const double volume = pow(g->spacing, 3), slope = 1 / (dipole_width() * dipole_width());
#pragma omp parallel for schedule(dynamic, 16)
    for (int i = 0; i < p->count; i++) {
        double V[3] = {0}, D[9] = {0};
        FOR_SUPPORT(g->support, interpolate_one(g, p, i, V, D, P))
        for (int c = 0; c < 3; c++) p->velocity[3 * i + c] = volume * V[c];
        for (int c = 0; c < 9; c++) p->gradient[9 * i + c] = volume * slope * D[c];
    }
}

static void evaluate(Grid *g, const Particles *p, double seconds[STAGES]) {
    double t0 = omp_get_wtime();
    spread(g, p);
    double t1 = omp_get_wtime();
    fftw_execute(g->forward);
    double t2 = omp_get_wtime();
    solve(g, p->edge);
    double t3 = omp_get_wtime();
    fftw_execute(g->backward);
    double t4 = omp_get_wtime();
    interpolate(g, p);
    double t5 = omp_get_wtime();
    seconds[SPREAD] = t1 - t0, seconds[FFT] = t2 - t1 + t4 - t3, seconds[SOLVE] = t3 - t2;
    seconds[INTERPOLATE] = t5 - t4, seconds[TOTAL] = t5 - t0;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double difference(const double *found, const double *exact, int count) {
    double error = 0, norm = 0;
    for (int i = 0; i < count; i++) error += pow(found[i] - exact[i], 2), norm += pow(exact[i], 2);
    return sqrt(error / norm);
}

int main(int argc, char **argv) {
    if (argc != 6) {
        fprintf(stderr, "usage: %s PARTICLES VOLUME_FRACTION GRID SUPPORT REPEATS\n", argv[0]);
        return 2;
    }
    int count = atoi(argv[1]), points = atoi(argv[3]), support = atoi(argv[4]), repeats = atoi(argv[5]);
    double fraction = atof(argv[2]);
    if (count < 1 || !(fraction > 0) || points < 4 || points % 2 || support < 2 || support % 2 || support > WIDEST ||
        support > points || repeats < 1) {
        fprintf(stderr, "counts and the fraction are positive, GRID and SUPPORT even, SUPPORT at most GRID and %d\n", WIDEST);
        return 2;
    }
    fftw_init_threads();
    Particles p = random_particles(count, fraction);
    Grid g = plan(points, support, p.edge, FFTW_MEASURE);
    double seconds[STAGES], (*all)[STAGES] = malloc(repeats * sizeof *all), median[STAGES], *sorted = numbers(repeats);
    evaluate(&g, &p, seconds);
    for (int r = 0; r < repeats; r++) evaluate(&g, &p, all[r]);
    for (int stage = 0; stage < STAGES; stage++) {
        for (int r = 0; r < repeats; r++) sorted[r] = all[r][stage];
        qsort(sorted, repeats, sizeof *sorted, ascending);
        median[stage] = sorted[repeats / 2];
    }
    drop(&g);

    double *velocity = p.velocity, *gradient = p.gradient;
    p.velocity = numbers(3 * count), p.gradient = numbers(9 * count);
    Grid fine = plan(points / 4 * 6, WIDEST < points ? WIDEST : points, p.edge, FFTW_ESTIMATE);
    evaluate(&fine, &p, seconds);
    double error = fmax(difference(velocity, p.velocity, 3 * count), difference(gradient, p.gradient, 9 * count));
    printf("{\"program\":\"fcm_direct\",\"particles\":%d,\"volume_fraction\":%g,\"method\":\"direct\",\"precision\":\"f64\","
           "\"grid\":[%d,%d,%d],\"support\":%d,\"ranks\":1,\"threads\":%d,\"seconds\":{\"spread\":%.6f,\"fft\":%.6f,"
           "\"solve\":%.6f,\"interpolate\":%.6f,\"near\":0,\"total\":%.6f},\"error\":%.3e}\n",
           count, fraction, points, points, points, support, omp_get_max_threads(), median[SPREAD], median[FFT],
           median[SOLVE], median[INTERPOLATE], median[TOTAL], error);
    return 0;
}
