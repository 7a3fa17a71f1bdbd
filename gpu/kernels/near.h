// Resistance of near pairs by rows, and the blocks that precondition it. All numbers are in f64, except those of soft
// pairs, which have the precision of the grid.
#pragma once
#include "vectors.h"

static constexpr int SIX = 6;
// Numbers of a pair: its axis; translation across the axis, and along it minus across; the same of rotation; force by
// rotation and torque by translation.
static constexpr int PAIR_NUMBERS = 9;
// Numbers of a row's own resistance: force by velocity and torque by rotation, xx, xy, xz, yy, yz and zz each, and
// the vector c of the coupling F = Omega x c, L = c x U.
static constexpr int OWN_NUMBERS = 15;
// Numbers of the first moment of a row's sphere at walls by its own motion.
static constexpr int WALL_NUMBERS = 3;
// Resistances of single spheres: to translation, rotation and strain.
static constexpr int RESISTANCES = 3;
static constexpr int ROW_LANES = 8;

static __device__ const double *resistances_of(const Task &task, int row)
{
    return task.resistances + RESISTANCES * task.classes[row];
}

// Component of a cross product.
static __device__ double across(const double a[3], const double b[3], int axis)
{
    int y = axis == 2 ? 0 : axis + 1, z = axis == 0 ? 2 : axis - 1;
    return a[y] * b[z] - a[z] * b[y];
}

static __device__ double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Adds the load of a pair on the sphere of its row due to the motion of the other sphere.
template <typename S>
__device__ void add_load(const Task &task, int set, long long entry, const double u[SIX], double load[SIX])
{
    double n[PAIR_NUMBERS];
    const S *numbers = (const S *)task.near_numbers[set] + entry;
    for (int k = 0; k < PAIR_NUMBERS; k++) n[k] = numbers[k * task.numbers->near_entries[set]];
    const double *turn = u + 3;
    double along = dot(n, u) * n[4], spin = dot(n, turn) * n[6];
    for (int k = 0; k < 3; k++) {
        load[k] += n[3] * u[k] + along * n[k] + n[7] * across(turn, n, k);
        load[3 + k] += n[5] * turn[k] + spin * n[k] + n[8] * across(n, u, k);
    }
}

// A component of the load on a sphere due to its own motion.
static __device__ double own_load(const double *own, const double u[SIX], int component)
{
    const double *turn = u + 3;
    bool is_force = component < 3;
    int axis = is_force ? component : component - 3;
    const double *block = is_force ? own : own + 6, *moved = is_force ? u : turn;
    double sum = is_force ? across(turn, own + 12, axis) : across(own + 12, u, axis);
    for (int k = 0; k < 3; k++) {
        int low = k < axis ? k : axis, high = k < axis ? axis : k;
        sum += block[low == 0 ? high : low + high + 1] * moved[k];
    }
    return sum;
}

// Motions of spheres, six numbers each: `u`, or `z + turn u`; with a turn of 0, u may be undefined.
struct Motions {
    const double *u, *z;
    double turn;

    __device__ void get(int row, double motion[SIX]) const
    {
        for (int k = 0; k < SIX; k++) {
            long long at = (long long)SIX * row + k;
            motion[k] = !z ? u[at] : turn == 0 ? z[at] : z[at] + turn * u[at];
        }
    }
};

// Adds the loads of the pairs of a row in a set, those of every eighth pair.
template <typename S>
__device__ void add_row(const Task &task, int set, int row, int lane, const Motions &motions, double load[SIX])
{
    if (!(task.pair_sets >> set & 1)) return;
    double motion[SIX];
    for (int entry = task.near_starts[set][row] + lane; entry < task.near_starts[set][row + 1]; entry += ROW_LANES) {
        motions.get(task.near_others[set][entry], motion);
        add_load<S>(task, set, entry, motion, load);
    }
}

// Loads of near pairs in some motions, by eight threads a row, and sums by blocks of their products with the motions;
// with those of single spheres if they are asked for. The motions are stored if there is a place for them.
template <typename S> __device__ void store_loads(const Task &task, const Motions &motions)
{
    SHARED(double, partial, SIX *SUM_THREADS);
    int thread = (int)threadIdx.x, lane = thread % ROW_LANES, first = thread - lane;
    int row = (int)(blockIdx.x * (SUM_THREADS / ROW_LANES)) + thread / ROW_LANES;
    bool is_there = row < task.particles;
    double load[SIX] = {0, 0, 0, 0, 0, 0}, product = 0;
    if (is_there) add_row<double>(task, STIFF, row, lane, motions, load);
    if (is_there) add_row<S>(task, SOFT, row, lane, motions, load);
    for (int k = 0; k < SIX; k++) partial[k * SUM_THREADS + thread] = load[k];
    __syncthreads();
    if (is_there && lane < SIX) {
        double motion[SIX], sum = 0;
        motions.get(row, motion);
        for (int set = 0; set < 2; set++)
            if (task.pair_sets >> set & 1) sum += own_load(task.near_own[set] + OWN_NUMBERS * row, motion, lane);
        for (int other = 0; other < ROW_LANES; other++) sum += partial[lane * SUM_THREADS + first + other];
        if (task.adds_single) sum += resistances_of(task, row)[lane < 3 ? 0 : 1] * motion[lane];
        task.image[SIX * row + lane] = sum;
        if (task.next_direction) task.next_direction[SIX * row + lane] = motion[lane];
        product = sum * motion[lane];
    }
    store_sum(product, task.list_sums + blockIdx.x);
}

// The same for the motions of a direction.
template <typename S> __device__ void row_loads(const Task &task)
{
    store_loads<S>(task, {task.direction, nullptr, 0});
}

// `image = residual - preconditioned - Z unknowns` with the resistance Z of single spheres; unknowns may be absent.
static __device__ void remainder_of_rows(const Task &task)
{
    long long at = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (at >= (long long)SIX * task.particles) return;
    double load = task.residual[at] - task.preconditioned[at];
    if (task.unknowns) load -= resistances_of(task, (int)(at / SIX))[at % SIX < 3 ? 0 : 1] * task.unknowns[at];
    task.image[at] = load;
}
