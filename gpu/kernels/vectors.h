// Vectors of an iteration: lists of values, some of them five for each particle in the order of the host, which stand
// for symmetric matrices without a trace.
#pragma once
#include "bins.h"

static constexpr int COMPONENTS = 5;

// `y = x_factor x + y_factor y`; a y that is not used may be undefined.
template <typename T> __device__ void combine(const Task &task)
{
    long long at = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (at >= task.list_size) return;
    T *y = (T *)task.list_y, sum = (T)task.x_factor * ((const T *)task.list_x)[at];
    y[at] = task.y_factor == 0 ? sum : sum + (T)task.y_factor * y[at];
}

// `y = x` times the weight of each particle's class.
template <typename T> __device__ void weigh(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    T weight = ((const T *)task.list_weights)[task.classes[row]];
    const T *x = (const T *)task.list_x + COMPONENTS * row;
    T *y = (T *)task.list_y + COMPONENTS * row;
    for (int i = 0; i < COMPONENTS; i++) y[i] = weight * x[i];
}

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

// Products of the matrices of each particle, over the weights of their classes if there are any, summed up by blocks.
template <typename T> __device__ void sum_products(const Task &task)
{
    int row = thread_index();
    double own = 0;
    if (row < task.particles) {
        double x[COMPONENTS], y[COMPONENTS];
        for (int i = 0; i < COMPONENTS; i++) x[i] = ((const T *)task.list_x)[COMPONENTS * row + i];
        for (int i = 0; i < COMPONENTS; i++) y[i] = ((const T *)task.list_y)[COMPONENTS * row + i];
        own = contracted(x, y);
        if (task.list_weights) own /= (double)((const T *)task.list_weights)[task.classes[row]];
    }
    store_sum(own, task.list_sums + blockIdx.x);
}

// Sums of the sums of all blocks, one after the other, by a block each.
static __device__ void add_sums(const Task &task)
{
    const double *sums = task.list_sums + blockIdx.x * task.list_size;
    double own = 0;
    for (long long block = threadIdx.x; block < task.list_size; block += SUM_THREADS) own += sums[block];
    store_sum(own, task.totals + blockIdx.x);
}
