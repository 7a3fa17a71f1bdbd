// Vectors of an iteration: lists of values, some of them five for each particle in the order of the host, which stand
// for symmetric matrices without a trace.
#pragma once
#include "bins.h"

static constexpr int COMPONENTS = 5;

static constexpr int SUM_THREADS = 256;

// Stores the sum over the threads of a block, which has the same bits in any order of threads.
static __device__ void store_sum(double own, double *sum)
{
    SHARED(double, sums, SUM_THREADS);
    int thread = (int)threadIdx.x;
    sums[thread] = own;
    __syncthreads();
    for (int half = SUM_THREADS / 2; half > 0; half /= 2) {
        if (thread < half) sums[thread] += sums[thread + half];
        __syncthreads();
    }
    if (thread == 0) *sum = sums[0];
}

// Sum of the sums of all blocks in a list, for all threads of a block, with the same bits in each.
static __device__ double sum_of_list(const Task &task, int list)
{
    SHARED(double, sums, SUM_THREADS);
    const double *of_blocks = task.block_sums + list * task.block_count;
    int thread = (int)threadIdx.x;
    double own = 0;
    for (long long block = thread; block < task.block_count; block += SUM_THREADS) own += of_blocks[block];
    sums[thread] = own;
    __syncthreads();
    for (int half = SUM_THREADS / 2; half > 0; half /= 2) {
        if (thread < half) sums[thread] += sums[thread + half];
        __syncthreads();
    }
    own = sums[0];
    __syncthreads();
    return own;
}

// Contraction of two symmetric matrices without a trace.
static __device__ double contracted(const double *x, const double *y)
{
    return x[0] * y[0] + x[3] * y[3] + (x[0] + x[3]) * (y[0] + y[3]) + 2 * (x[1] * y[1] + x[2] * y[2] + x[4] * y[4]);
}

// Sums of the sums of all blocks, one after the other, by a block each.
static __device__ void add_sums(const Task &task)
{
    const double *sums = task.list_sums + blockIdx.x * task.list_size;
    double own = 0;
    for (long long block = threadIdx.x; block < task.list_size; block += SUM_THREADS) own += sums[block];
    store_sum(own, task.totals + blockIdx.x);
}
