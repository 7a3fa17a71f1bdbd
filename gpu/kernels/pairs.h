// Pair corrections, and the motions of the particles.
#pragma once
#include "interpolate.h"
#include "neighbours.h"

// Pair functions in the order of fcm/src/pairs/table.rs, coefficients of an interval, and threads of a particle.
static constexpr int FUNCTIONS = 9;
static constexpr int COEFFICIENTS = 6;
static constexpr int PAIR_LANES = 8;
static constexpr int PAIR_THREADS = 128;

// Pair functions of two classes at the square of a distance.
template <typename T> __device__ void pair_functions(const Task &task, int pair, T square, T f[FUNCTIONS])
{
    T at = square * (T)task.intervals_per_square[pair];
    int interval = (int)at;
    if (interval >= task.table_sizes[pair]) interval = task.table_sizes[pair] - 1;
    T t = 2 * (at - (T)interval) - 1;
    const T *row = (const T *)task.tables + (long long)(task.table_starts[pair] + interval) * COEFFICIENTS * FUNCTIONS;
    for (int n = 0; n < FUNCTIONS; n++) f[n] = row[(COEFFICIENTS - 1) * FUNCTIONS + n];
    for (int power = COEFFICIENTS - 2; power >= 0; power--)
        for (int n = 0; n < FUNCTIONS; n++) f[n] = f[n] * t + row[power * FUNCTIONS + n];
}

// Adds the flow of a force and a dipole at a distance x from them, and its gradient row by row.
template <typename T> __device__ void add_pair(const T x[3], const T *record, const T f[FUNCTIONS], T sums[MOTION])
{
    const T *force = record, *g = record + 3;
    T square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2], along = 0, gx[3], xg[3], xgx = 0;
    for (int a = 0; a < 3; a++) {
        along += x[a] * force[a];
        gx[a] = g[3 * a] * x[0] + g[3 * a + 1] * x[1] + g[3 * a + 2] * x[2];
        xg[a] = g[a] * x[0] + g[3 + a] * x[1] + g[6 + a] * x[2];
    }
    for (int a = 0; a < 3; a++) xgx += x[a] * gx[a];
    T of_force = -(square * f[1] + 2 * f[0]), of_dipole = -(square * f[3] + 4 * f[2]);
    T force_slope = -(square * f[5] + 4 * f[4]), twist = -(square * f[7] + 4 * f[6]), bend = -(square * f[8] + 6 * f[7]);
    T across = along * f[1] + xgx * f[3], trace = along * f[4] + xgx * f[7], slope = along * f[5] + xgx * f[8];
    T left[3], right[3];
    for (int a = 0; a < 3; a++) {
        sums[a] += force[a] * of_force + x[a] * across + gx[a] * of_dipole + xg[a] * f[2];
        left[a] = x[a] * slope + force[a] * force_slope + gx[a] * bend + xg[a] * f[7];
        right[a] = force[a] * f[4] + (gx[a] + xg[a]) * f[7];
    }
    for (int a = 0; a < 3; a++)
        for (int d = 0; d < 3; d++)
            sums[3 + 3 * a + d] += left[a] * x[d] + x[a] * right[d] + g[3 * a + d] * twist + g[3 * d + a] * f[6]
                                   + (a == d ? trace : (T)0);
}

// Adds what a particle's own correction and the grid contribute to its motion.
template <typename T> __device__ void add_own(const Task &task, int place, T motion[MOTION])
{
    const T *record = (const T *)task.records + 12 * place, *g = record + 3;
    const T *alone = (const T *)task.isolated + 2 * task.sorted_classes[place];
    const T *grid = (const T *)task.interpolated + MOTION * place;
    const Numbers &box = *task.numbers;
    T viscosity = (T)task.inverse_viscosity;
    for (int a = 0; a < 3; a++) {
        motion[a] = (motion[a] - 2 * alone[0] * record[a]) * viscosity + grid[a];
        T x = grid[3 + a] * (T)box.inverse_spacing[0], y = grid[6 + a] * (T)box.inverse_spacing[1];
        T z = grid[9 + a] * (T)box.inverse_spacing[2];
        T gradient[3] = {x, y - (T)box.strain * x, z - (T)box.tilt_y * y - (T)box.tilt_across * x};
        for (int d = 0; d < 3; d++) {
            T own = alone[1] * (g[3 * d + a] - 4 * g[3 * a + d]);
            motion[3 + 3 * a + d] = (motion[3 + 3 * a + d] + own) * viscosity - gradient[d];
        }
    }
}

// Motion along the axes of space from that along the axes of the box.
template <typename T> __device__ void rotate(const Task &task, T motion[MOTION])
{
    const double *axes = task.numbers->axes;
    T from[MOTION];
    for (int i = 0; i < MOTION; i++) from[i] = motion[i], motion[i] = 0;
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++) {
            motion[a] += (T)axes[3 * a + c] * from[c];
            for (int b = 0; b < 3; b++)
                for (int d = 0; d < 3; d++)
                    motion[3 + 3 * a + b] += (T)axes[3 * a + c] * from[3 + 3 * c + d] * (T)axes[3 * b + d];
        }
}

// Stores the motion of a particle, or adds it to what is there.
template <typename T, bool ADDS> __device__ void store_motion(const Task &task, int row, const T motion[MOTION])
{
    const T *d = motion + 3, third = (d[0] + d[4] + d[8]) / 3;
    if (task.velocities)
        for (int a = 0; a < 3; a++) {
            T *to = (T *)task.velocities + 3 * row + a;
            *to = ADDS ? *to + motion[a] : motion[a];
        }
    if (!task.strain_rates) return;
    const T of_turn[3] = {(d[7] - d[5]) / 2, (d[2] - d[6]) / 2, (d[3] - d[1]) / 2};
    const T of_strain[5] = {d[0] - third, (d[1] + d[3]) / 2, (d[2] + d[6]) / 2, d[4] - third, (d[5] + d[7]) / 2};
    T *turn = (T *)task.angular_velocities + 3 * row, *strain = (T *)task.strain_rates + 5 * row;
    for (int a = 0; a < 3; a++) turn[a] = ADDS ? turn[a] + of_turn[a] : of_turn[a];
    for (int k = 0; k < 5; k++) strain[k] = ADDS ? strain[k] + of_strain[k] : of_strain[k];
}

// Motions of the particles: the sums over neighbours, and what the grid contributes.
template <typename T> __device__ void pair_motions(const Task &task)
{
    SHARED(T, partial, MOTION *PAIR_THREADS);
    int thread = (int)threadIdx.x, lane = thread % PAIR_LANES, group = thread / PAIR_LANES;
    int target = (int)blockIdx.x * (PAIR_THREADS / PAIR_LANES) + group;
    bool is_there = is_owned(task, target);
    T sums[MOTION];
    for (int i = 0; i < MOTION; i++) sums[i] = 0;
    int end = is_there ? task.neighbour_starts[target + 1] : 0;
    for (int entry = is_there ? task.neighbour_starts[target] + lane : 0; entry < end; entry += PAIR_LANES) {
        int source = task.neighbours[2 * entry], packed = task.neighbours[2 * entry + 1], steps[3];
        for (int axis = 0; axis < 3; axis++) steps[axis] = steps_along(packed, axis);
        int pair = task.sorted_classes[target] * task.class_count + task.sorted_classes[source];
        T x[3], f[FUNCTIONS];
        separation<T>(task, target, source, steps, x);
        pair_functions<T>(task, pair, x[0] * x[0] + x[1] * x[1] + x[2] * x[2], f);
        add_pair<T>(x, (const T *)task.records + 12 * source, f, sums);
    }
    for (int i = 0; i < MOTION; i++) partial[i * PAIR_THREADS + thread] = sums[i];
    __syncthreads();
    if (!is_there || lane > 0) return;
    T motion[MOTION];
    for (int i = 0; i < MOTION; i++) {
        motion[i] = 0;
        for (int other = 0; other < PAIR_LANES; other++) motion[i] += partial[i * PAIR_THREADS + thread + other];
    }
    add_own<T>(task, target, motion);
    if (task.is_rotated) rotate<T>(task, motion);
    store_motion<T, false>(task, task.rows[target], motion);
}
