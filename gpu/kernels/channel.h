// Flow of walls, and of open faces, besides the periodic solve: solver/src/channel has the equations.
//
// For each wavevector along the walls the flow of the walls and of the grid's periodic copies is a sum of s^i and i s^i,
// s = exp(-k h), in the index i of a plane counted from either end of the grid, with weights of the forces that are the
// same functions. Their transforms over the planes are geometric sums, so moments and flows are sums over modes:
//   sum_i w_i f_i = 1/n sum_m W(m) F(m),   W(m) = sum_i w_i exp(2 pi i m/n),   u_i += a w_i:   U(m) += a/n conj(W(m))
// All of this is in f64, because for long waves the flow of the walls and that of unbounded fluid nearly cancel.
#pragma once
#include "solve.h"

// Columns of modes of a block, threads of a column, and threads of the block for the mean.
static constexpr int CHANNEL_COLUMNS = 32;
static constexpr int CHANNEL_SLICES = 4;
static constexpr int MEAN_THREADS = 128;

// Sums by wall, function, component and part; entries of a symmetric matrix for two components and both functions.
static constexpr int WALL_SUMS = 24;
static constexpr int ALONG_WALLS = 36;

// Numbers of a plane: cosine, sine, and 1 - cosine of its turn, and transforms of three weights for the mean.
static constexpr int PLANE_NUMBERS = 9;

typedef Complex<double> Wide;

static __device__ Wide product(Wide a, Wide b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }

// Functions of a column: s, 1 - s, n s^n and 1 - s^n for n planes.
struct ColumnDecay {
    double step, less, last, all;

    __device__ ColumnDecay(double decay, int planes)
        : step(exp(-decay)), less(-expm1(-decay)), last(planes * exp(-decay * planes)), all(-expm1(-decay * planes))
    {
    }
};

// Transforms of s^i and i s^i at a mode by its turn q: (1 - s^n)/(1 - s q), and that of its derivative by log s. Those
// of the same functions from the upper end are their conjugates over q.
static __device__ void column_weights(const ColumnDecay &of, const double *turn, Wide lower[2], Wide upper[2])
{
    double cosine = turn[0], sine = turn[1], re = of.less + of.step * turn[2], im = -of.step * sine;
    double over = 1 / (re * re + im * im);
    Wide inverse = {re * over, -im * over}, stepped = {of.step * cosine, of.step * sine};
    lower[0] = {of.all * inverse.re, of.all * inverse.im};
    Wide slope = product(stepped, lower[0]);
    lower[1] = product({slope.re - of.last, slope.im}, inverse);
    for (int function = 0; function < 2; function++)
        upper[function] = product({cosine, -sine}, {lower[function].re, -lower[function].im});
}

// Place of a wall's sum in a list.
static __device__ int wall_sum(int wall, int function, int component) { return 2 * (component + 3 * (function + 2 * wall)); }

// Adds the moments of the forces of a mode.
static __device__ void add_moments(const Wide weights[2], int wall, const Wide force[3], double sums[WALL_SUMS])
{
    for (int function = 0; function < 2; function++)
        for (int c = 0; c < 3; c++) {
            Wide moment = product(weights[function], force[c]);
            sums[wall_sum(wall, function, c)] += moment.re;
            sums[wall_sum(wall, function, c) + 1] += moment.im;
        }
}

// Adds the flow of amplitudes at a mode to a velocity.
static __device__ void add_flow(const Wide weights[2], int wall, const double amplitudes[WALL_SUMS], Wide velocity[3])
{
    for (int function = 0; function < 2; function++)
        for (int c = 0; c < 3; c++) {
            const double *amplitude = amplitudes + wall_sum(wall, function, c);
            Wide flow = product({weights[function].re, -weights[function].im}, {amplitude[0], amplitude[1]});
            velocity[c].re += flow.re;
            velocity[c].im += flow.im;
        }
}

// Turns the moments of a column into amplitudes: along the wavevector and over i across the walls by a matrix, normal to
// both by another one of the first function alone.
static __device__ void solve_column(const double *numbers, int stride, double sums[WALL_SUMS])
{
    double n1 = numbers[stride], n2 = numbers[2 * stride], along[8][2], across[2][2];
    const double *matrix = numbers + 3 * stride, *of_across = matrix + ALONG_WALLS * stride;
    for (int place = 0; place < 4; place++) {
        const double *x = sums + 6 * place, *y = x + 2, *z = x + 4;
        for (int part = 0; part < 2; part++) {
            along[place][part] = n1 * x[part] + n2 * y[part];
            if (place % 2 == 0) across[place / 2][part] = n1 * y[part] - n2 * x[part];
        }
        along[4 + place][0] = z[1], along[4 + place][1] = -z[0];
    }
    for (int place = 0; place < 4; place++) {
        double l[2] = {0, 0}, normal[2] = {0, 0}, *to = sums + 6 * place;
        for (int q = 0; q < 8; q++) {
            int p = place, high = p > q ? p : q, low = p > q ? q : p, below = 4 + place;
            double entry = matrix[(high * (high + 1) / 2 + low) * stride];
            high = below > q ? below : q, low = below > q ? q : below;
            double of_normal = matrix[(high * (high + 1) / 2 + low) * stride];
            for (int part = 0; part < 2; part++) {
                l[part] += entry * along[q][part];
                normal[part] += of_normal * along[q][part];
            }
        }
        for (int part = 0; part < 2; part++) {
            int wall = place / 2;
            double t = of_across[wall * stride] * across[0][part] + of_across[(wall + 1) * stride] * across[1][part];
            if (place % 2 == 1) t = 0;
            to[part] = n1 * l[part] - n2 * t;
            to[2 + part] = n2 * l[part] + n1 * t;
        }
        to[4] = -normal[1], to[5] = normal[0];
    }
}

// Force of a mode.
template <typename T> __device__ void force_of_mode(const Task &task, long long at, Wide force[3])
{
    for (int c = 0; c < 3; c++) {
        Complex<T> value = ((const Complex<T> *)task.spectrum)[at + c * modes_of(task)];
        force[c] = {(double)value.re, (double)value.im};
    }
}

// Amplitudes of the mean flow along x and y, of a wavevector without a length along the walls: three weights of planes
// and a matrix. One block.
template <typename T> __device__ void mean_of_channel(const Task &task)
{
    SHARED(double, partial, 6 * MEAN_THREADS);
    SHARED(double, moments, 6);
    int thread = (int)threadIdx.x, planes = task.grid[2], columns = (task.grid[0] / 2 + 1) * task.grid[1];
    double sums[6] = {0, 0, 0, 0, 0, 0};
    for (int plane = thread; plane < planes; plane += MEAN_THREADS) {
        const double *weights = task.channel_planes + PLANE_NUMBERS * plane + 3;
        Wide force[3];
        force_of_mode<T>(task, (long long)plane * columns, force);
        for (int k = 0; k < 6; k++)
            sums[k] += product({weights[2 * (k % 3)], weights[2 * (k % 3) + 1]}, force[k / 3]).re;
    }
    for (int k = 0; k < 6; k++) partial[k * MEAN_THREADS + thread] = sums[k];
    __syncthreads();
    if (thread < 6) {
        double sum = 0;
        for (int other = 0; other < MEAN_THREADS; other++) sum += partial[thread * MEAN_THREADS + other];
        moments[thread] = sum / planes;
    }
    __syncthreads();
    if (thread >= 6) return;
    double amplitude = 0;
    for (int q = 0; q < 3; q++) amplitude += task.channel_mean[3 * (thread % 3) + q] * moments[3 * (thread / 3) + q];
    task.channel_amplitudes[thread] = amplitude / planes;
}

// Adds the mean flow at a mode to a velocity.
static __device__ void add_mean(const Task &task, int plane, Wide velocity[3])
{
    const double *weights = task.channel_planes + PLANE_NUMBERS * plane + 3;
    for (int k = 0; k < 6; k++) {
        velocity[k / 3].re += task.channel_amplitudes[k] * weights[2 * (k % 3)];
        velocity[k / 3].im -= task.channel_amplitudes[k] * weights[2 * (k % 3) + 1];
    }
}

// Multiplies modes by the periodic Green's function, and adds the flow of walls and open faces.
template <typename T> __device__ void solve_channel(const Task &task)
{
    constexpr int THREADS = CHANNEL_COLUMNS * CHANNEL_SLICES;
    SHARED(double, partial, WALL_SUMS *THREADS);
    int thread = (int)threadIdx.x, lane = thread % CHANNEL_COLUMNS, slice = thread / CHANNEL_COLUMNS;
    int planes = task.grid[2], columns = (task.grid[0] / 2 + 1) * task.grid[1];
    int column = (int)blockIdx.x * CHANNEL_COLUMNS + lane;
    bool is_there = column < columns;
    const double *numbers = task.channel_columns + column, *turns = task.channel_planes;
    double decay = is_there ? numbers[0] : 0;
    ColumnDecay functions(decay, planes);
    double sums[WALL_SUMS];
    Wide force[3], lower[2], upper[2];
    for (int k = 0; k < WALL_SUMS; k++) sums[k] = 0;
    for (int plane = slice; decay > 0 && plane < planes; plane += CHANNEL_SLICES) {
        column_weights(functions, turns + PLANE_NUMBERS * plane, lower, upper);
        force_of_mode<T>(task, (long long)plane * columns + column, force);
        add_moments(lower, 0, force, sums);
        add_moments(upper, 1, force, sums);
    }
    for (int k = 0; k < WALL_SUMS; k++) partial[k * THREADS + thread] = sums[k];
    __syncthreads();
    for (int k = 0; k < WALL_SUMS; k++) {
        sums[k] = 0;
        for (int other = 0; other < CHANNEL_SLICES; other++)
            sums[k] += partial[k * THREADS + other * CHANNEL_COLUMNS + lane];
        sums[k] /= (double)planes * planes;
    }
    if (!is_there) return;
    if (decay > 0) solve_column(numbers, columns, sums);
    for (int plane = slice; plane < planes; plane += CHANNEL_SLICES) {
        int at = plane * columns + column;
        force_of_mode<T>(task, at, force);
        Complex<T> narrow[3];
        for (int c = 0; c < 3; c++) narrow[c] = {(T)force[c].re, (T)force[c].im};
        Mode<T> mode = mode_at<T>(task, at);
        Wide velocity[3];
        across_mode<T>(mode, mode.factor, narrow);
        for (int c = 0; c < 3; c++) velocity[c] = {(double)narrow[c].re, (double)narrow[c].im};
        if (decay > 0) {
            column_weights(functions, turns + PLANE_NUMBERS * plane, lower, upper);
            add_flow(lower, 0, sums, velocity);
            add_flow(upper, 1, sums, velocity);
        }
        if (column == 0) add_mean(task, plane, velocity);
        for (int c = 0; c < 3; c++)
            ((Complex<T> *)task.spectrum)[at + c * modes_of(task)] = {(T)velocity[c].re, (T)velocity[c].im};
    }
}
