// Flow of walls, and of open faces, besides the periodic solve: solver/src/channel has the equations.
//
// For each wavevector along the walls the flow of the walls and of the grid's periodic copies is a sum of s^i and i s^i,
// s = exp(-k h), in the index i of a plane counted from either end of the grid. The moments of the forces have the same
// functions as weights. The modes are those of planes, [component][z][m2][m1], which are transformed along z only after
// the moments have been taken, and back before the flow is added: round-off of forces far from a wall would be as large at
// the wall. All of this is in f64, because for long waves the flow of the walls and that of unbounded fluid nearly cancel.
#pragma once
#include "solve.h"

// Columns of modes of a block, threads of a column, and threads of the block for the mean.
static constexpr int CHANNEL_COLUMNS = 32;
static constexpr int CHANNEL_SLICES = 4;
static constexpr int MEAN_THREADS = 128;

// Sums by end, function, component and part; entries of a symmetric matrix for two components and all functions.
static constexpr int WALL_SUMS = 24;
static constexpr int ALONG_WALLS = 36;

// Number of columns, whether one is that of the mean, and the place of a mode of a plane.
static __device__ int columns_of(const Task &task) { return (task.grid[0] / 2 + 1) * task.modes; }

static __device__ bool is_mean(const Task &task, int column) { return column == 0 && task.first_mode == 0; }

template <typename T> __device__ Complex<T> *mode_of_plane(const Task &task, int component, int plane, int column)
{
    return (Complex<T> *)task.spectrum + component * modes_of(task) + (long long)plane * columns_of(task) + column;
}

// Values of the functions at a plane, by end and function.
static __device__ void column_weights(double decay, int plane, int planes, double weights[4])
{
    for (int end = 0; end < 2; end++) {
        int index = end == 0 ? plane : planes - 1 - plane;
        weights[2 * end] = exp(-decay * index);
        weights[2 * end + 1] = index * weights[2 * end];
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

// Amplitudes of the mean flow along x and y, of a wavevector without a length along the walls: three weights of planes
// and a matrix. One block.
template <typename T> __device__ void channel_mean(const Task &task)
{
    SHARED(double, partial, 6 * MEAN_THREADS);
    SHARED(double, moments, 6);
    int thread = (int)threadIdx.x;
    double sums[6] = {0, 0, 0, 0, 0, 0};
    for (int plane = thread; plane < task.grid[2]; plane += MEAN_THREADS)
        for (int k = 0; k < 6; k++)
            sums[k] += task.channel_planes[3 * plane + k % 3] * (double)mode_of_plane<T>(task, k / 3, plane, 0)->re;
    for (int k = 0; k < 6; k++) partial[k * MEAN_THREADS + thread] = sums[k];
    __syncthreads();
    if (thread < 6) {
        moments[thread] = 0;
        for (int other = 0; other < MEAN_THREADS; other++) moments[thread] += partial[thread * MEAN_THREADS + other];
    }
    __syncthreads();
    if (thread >= 6) return;
    double amplitude = 0;
    for (int q = 0; q < 3; q++) amplitude += task.channel_mean[3 * (thread % 3) + q] * moments[3 * (thread / 3) + q];
    task.channel_amplitudes[WALL_SUMS * columns_of(task) + thread] = amplitude;
}

// Amplitudes of the flow of each column, by its moments.
template <typename T> __device__ void channel_moments(const Task &task)
{
    constexpr int THREADS = CHANNEL_COLUMNS * CHANNEL_SLICES;
    SHARED(double, partial, WALL_SUMS *THREADS);
    int thread = (int)threadIdx.x, lane = thread % CHANNEL_COLUMNS, slice = thread / CHANNEL_COLUMNS;
    int planes = task.grid[2], columns = columns_of(task), column = (int)blockIdx.x * CHANNEL_COLUMNS + lane;
    double decay = column < columns ? task.channel_columns[column] : 0, sums[WALL_SUMS], weights[4];
    for (int k = 0; k < WALL_SUMS; k++) sums[k] = 0;
    for (int plane = slice; decay > 0 && plane < planes; plane += CHANNEL_SLICES) {
        column_weights(decay, plane, planes, weights);
        for (int c = 0; c < 3; c++) {
            Complex<T> force = *mode_of_plane<T>(task, c, plane, column);
            for (int place = 0; place < 4; place++) {
                sums[6 * place + 2 * c] += weights[place] * (double)force.re;
                sums[6 * place + 2 * c + 1] += weights[place] * (double)force.im;
            }
        }
    }
    for (int k = 0; k < WALL_SUMS; k++) partial[k * THREADS + thread] = sums[k];
    __syncthreads();
    if (decay <= 0 || slice > 0) return;
    for (int k = 0; k < WALL_SUMS; k++) {
        sums[k] = 0;
        for (int other = 0; other < CHANNEL_SLICES; other++)
            sums[k] += partial[k * THREADS + other * CHANNEL_COLUMNS + lane];
    }
    solve_column(task.channel_columns + column, columns, sums);
    for (int k = 0; k < WALL_SUMS; k++) task.channel_amplitudes[k * columns + column] = sums[k];
}

// Adds the flow of the amplitudes of each column, and the mean.
template <typename T> __device__ void channel_flow(const Task &task)
{
    int thread = (int)threadIdx.x, lane = thread % CHANNEL_COLUMNS, slice = thread / CHANNEL_COLUMNS;
    int planes = task.grid[2], columns = columns_of(task), column = (int)blockIdx.x * CHANNEL_COLUMNS + lane;
    if (column >= columns) return;
    double decay = task.channel_columns[column], amplitudes[WALL_SUMS], weights[4];
    const double *mean = task.channel_amplitudes + WALL_SUMS * columns;
    for (int k = 0; k < WALL_SUMS; k++) amplitudes[k] = decay > 0 ? task.channel_amplitudes[k * columns + column] : 0;
    for (int plane = slice; (decay > 0 || is_mean(task, column)) && plane < planes; plane += CHANNEL_SLICES) {
        column_weights(decay, plane, planes, weights);
        for (int c = 0; c < 3; c++) {
            Complex<T> *velocity = mode_of_plane<T>(task, c, plane, column);
            double re = (double)velocity->re, im = (double)velocity->im;
            for (int place = 0; place < 4; place++) {
                re += weights[place] * amplitudes[6 * place + 2 * c];
                im += weights[place] * amplitudes[6 * place + 2 * c + 1];
            }
            for (int p = 0; is_mean(task, column) && c < 2 && p < 3; p++)
                re += task.channel_planes[3 * plane + p] * mean[3 * c + p];
            *velocity = {(T)re, (T)im};
        }
    }
}
