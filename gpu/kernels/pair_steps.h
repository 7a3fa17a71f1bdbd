// Steps of conjugate gradients for motions u of spheres that interact by near pairs alone, `(M_0^-1 + R) u = f`,
// preconditioned by the inverses of groups. A step is two kernels, each of which adds up the sums of all blocks of the
// kernel before it: one for the next direction and its image, one for what follows from a step along it.
#pragma once
#include "groups.h"

// Inner products of a residual r and a preconditioned residual z: `r z`, r times the former z, and the squares of an
// error and of a size.
static constexpr int PRODUCTS = 4;

// Part of the last direction in the next one, and whether the iteration goes on, which the first block notes.
static __device__ bool begin_turn(const Task &task, double *turn)
{
    PairState &state = task.state->pairs;
    bool is_first = blockIdx.x == 0 && threadIdx.x == 0, goes_on = state.goes_on[1 - task.parity] != 0;
    if (goes_on) {
        double now[PRODUCTS], before = state.products[1 - task.parity];
        for (int list = 0; list < PRODUCTS; list++) now[list] = sum_of_list(task, list);
        bool is_small = fabs(now[2]) <= state.square * now[3] || now[2] == 0;
        goes_on = !is_small && now[0] > 0 && now[0] <= 1.7976931348623157e308;
        *turn = before == 0 ? 0 : (now[0] - now[1]) / before;
        if (is_first) state.products[task.parity] = now[0];
    }
    if (is_first) state.goes_on[task.parity] = goes_on;
    return goes_on;
}

// The next direction, `z + turn p`, and its image. In an iteration that has ended nothing changes.
template <typename S> __device__ void turn_rows(const Task &task)
{
    double turn = 0;
    if (begin_turn(task, &turn)) store_loads<S>(task, {task.direction, task.preconditioned, turn});
}

// Sums of each product over a block of threads.
static __device__ void store_products(const Task &task, const double own[PRODUCTS])
{
    double *sums = task.list_sums + blockIdx.x;
    for (int list = 0; list < PRODUCTS; list++) store_sum(own[list], sums + list * task.list_size);
}

// A component of the preconditioned residual of a group, from that of all spheres of a block.
static __device__ double preconditioned(const Task &task, const GroupMember &member, int place, const double *residual)
{
    int width = SIX * member.count, component = place - SIX * member.first;
    const double *column = inverse_at(task, (long long)blockIdx.x * BLOCK_MEMBERS + member.first) + component;
    double sum = 0;
    for (int k = 0; k < width; k++) sum += column[k * width] * residual[SIX * member.first + k];
    return sum;
}

// A step along a direction, if there is one, and the residual preconditioned by groups.
static __device__ void step_rows(const Task &task)
{
    SHARED(double, residual, SUM_THREADS);
    if (task.direction && task.state->pairs.goes_on[task.parity] == 0) return;
    double length = task.direction ? task.state->pairs.products[task.parity] / sum_of_list(task, 0) : 0;
    int thread = (int)threadIdx.x, slot = thread / SIX, component = thread % SIX;
    GroupMember member = {-1, 0, 0};
    if (slot < BLOCK_MEMBERS) member = task.members[(long long)blockIdx.x * BLOCK_MEMBERS + slot];
    long long at = (long long)SIX * member.row + component;
    double sums[PRODUCTS] = {0, 0, 0, 0};
    if (member.row >= 0) {
        if (task.direction) {
            task.unknowns[at] += length * task.direction[at];
            task.residual[at] -= length * task.image[at];
            sums[1] = task.residual[at] * task.preconditioned[at];
        }
        residual[thread] = task.residual[at];
    }
    __syncthreads();
    if (member.row >= 0) {
        double r = residual[thread], x = task.unknowns[at], z = preconditioned(task, member, thread, residual);
        double single = resistances_of(task, member.row)[component < 3 ? 0 : 1];
        task.preconditioned[at] = z;
        sums[0] = r * z, sums[2] = r * r / single, sums[3] = x * x * single;
    }
    store_products(task, sums);
    if (task.direction && blockIdx.x == 0 && thread == 0) task.state->pairs.steps += 1;
}
