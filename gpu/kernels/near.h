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
// Numbers of the lower triangle of a block.
static constexpr int TRIANGLE = 21;
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
template <typename S> __device__ void add_load(const Task &task, long long entry, double load[SIX])
{
    double n[PAIR_NUMBERS];
    for (int k = 0; k < PAIR_NUMBERS; k++) n[k] = ((const S *)task.row_numbers)[k * task.row_entries + entry];
    const double *u = task.direction + SIX * task.row_others[entry], *turn = u + 3;
    double along = dot(n, u) * n[4], spin = dot(n, turn) * n[6];
    for (int k = 0; k < 3; k++) {
        load[k] += n[3] * u[k] + along * n[k] + n[7] * across(turn, n, k);
        load[3 + k] += n[5] * turn[k] + spin * n[k] + n[8] * across(n, u, k);
    }
}

// A component of the load on a sphere due to its own motion.
static __device__ double own_load(const Task &task, int row, int component)
{
    const double *own = task.row_own + OWN_NUMBERS * row, *u = task.direction + SIX * row, *turn = u + 3;
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

// Loads of near pairs in a direction, by eight threads a row, and sums by blocks of their products with the direction.
// The loads are added to an image or replace it, with those of single spheres if they are asked for. In an iteration
// that has ended nothing changes.
template <typename S> __device__ void row_loads(const Task &task)
{
    SHARED(double, partial, SIX *SUM_THREADS);
    if (task.state && task.state->is_active == 0) return;
    int thread = (int)threadIdx.x, lane = thread % ROW_LANES, first = thread - lane;
    int row = (int)(blockIdx.x * (SUM_THREADS / ROW_LANES)) + thread / ROW_LANES;
    bool is_there = row < task.particles;
    double load[SIX] = {0, 0, 0, 0, 0, 0}, product = 0;
    int end = is_there ? task.row_starts[row + 1] : 0;
    for (int entry = is_there ? task.row_starts[row] + lane : 0; entry < end; entry += ROW_LANES)
        add_load<S>(task, entry, load);
    for (int k = 0; k < SIX; k++) partial[k * SUM_THREADS + thread] = load[k];
    __syncthreads();
    if (is_there && lane < SIX) {
        double sum = own_load(task, row, lane), moved = task.direction[SIX * row + lane];
        for (int other = 0; other < ROW_LANES; other++) sum += partial[lane * SUM_THREADS + first + other];
        if (task.adds_single) sum += resistances_of(task, row)[lane < 3 ? 0 : 1] * moved;
        if (task.adds_rows) sum += task.image[SIX * row + lane];
        task.image[SIX * row + lane] = sum;
        product = sum * moved;
    }
    store_sum(product, task.list_sums + blockIdx.x);
}

// Inner products of a residual r and a preconditioned residual z: `r z`, r times the former z, and the squares of an
// error and of a size.
struct Products {
    double product, former, error, size;
};

// Sums of each over a block of threads.
static __device__ void store_products(const Task &task, const Products &own)
{
    double *to = task.list_sums + blockIdx.x;
    store_sum(own.product, to);
    store_sum(own.former, to + task.list_size);
    store_sum(own.error, to + 2 * task.list_size);
    store_sum(own.size, to + 3 * task.list_size);
}

// A step of an iteration along a direction, if there is one, and the residual preconditioned by blocks.
static __device__ void step_rows(const Task &task)
{
    if (task.direction && task.state->is_active == 0) return;
    int row = thread_index();
    Products sums = {0, 0, 0, 0};
    if (row < task.particles) {
        double *x = task.unknowns + SIX * row, *r = task.residual + SIX * row, *z = task.preconditioned + SIX * row;
        const double *block = task.row_inverses + TRIANGLE * row;
        for (int k = 0; task.direction && k < SIX; k++) {
            x[k] += task.state->length * task.direction[SIX * row + k];
            r[k] -= task.state->length * task.image[SIX * row + k];
            sums.former += r[k] * z[k];
        }
        for (int k = 0; k < SIX; k++) {
            double sum = 0, single = resistances_of(task, row)[k < 3 ? 0 : 1];
            for (int m = 0; m < SIX; m++) {
                int low = k < m ? k : m, high = k < m ? m : k;
                sum += block[high * (high + 1) / 2 + low] * r[m];
            }
            z[k] = sum;
            sums.product += r[k] * sum;
            sums.error += r[k] * r[k] / single;
            sums.size += x[k] * x[k] * single;
        }
    }
    store_products(task, sums);
}

// Sum of the sums of all blocks in a list, by one block.
static __device__ void add_list(const Task &task, int list)
{
    const double *sums = task.list_sums + list * task.list_size;
    double own = 0;
    for (long long block = threadIdx.x; block < task.list_size; block += SUM_THREADS) own += sums[block];
    store_sum(own, task.totals + list);
}

// Length of the next step, from the product of a direction and its image, by one block.
static __device__ void set_length(const Task &task)
{
    if (task.state->is_active == 0) return;
    add_list(task, 0);
    if (threadIdx.x > 0) return;
    task.state->length = task.state->product / task.totals[0];
    task.state->steps += 1;
}

// Part of the last direction in the next, and whether the iteration goes on, from the sums after a step, or without a
// direction at the start; by one block.
static __device__ void set_turn(const Task &task)
{
    if (task.direction && task.state->is_active == 0) return;
    for (int list = 0; list < 4; list++) add_list(task, list);
    if (threadIdx.x > 0) return;
    PairState &state = *task.state;
    Products now = {task.totals[0], task.totals[1], task.totals[2], task.totals[3]};
    state.turn = task.direction ? (now.product - now.former) / state.product : 0;
    state.product = now.product;
    bool is_small = fabs(now.error) <= state.square * now.size || now.error == 0;
    state.is_active = !is_small && now.product > 0 && now.product <= 1.7976931348623157e308;
}

// Next direction of an iteration; the first may be undefined.
static __device__ void turn_direction(const Task &task)
{
    long long at = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (at >= (long long)SIX * task.particles) return;
    double turn = task.state->turn, z = task.preconditioned[at];
    task.image[at] = turn == 0 ? z : z + turn * task.image[at];
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
