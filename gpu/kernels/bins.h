// Order of the particles by bins of the grid.
#pragma once
#include "precision.h"
#include "task.h"

// Points of a bin and of a tile along an axis; a tile is the part of the grid that one block of threads spreads to.
static constexpr int BIN = 4;
static constexpr int TILE = 8;

static __device__ int thread_index()
{
    return (int)(blockIdx.x * blockDim.x + threadIdx.x);
}

// Key of the bin of each particle, and the number of particles of each bin.
template <typename T> __device__ void bin_particles(const Task &task)
{
    typedef typename Precision<T>::Fixed Fixed;
    int row = thread_index();
    if (row >= task.particles) return;
    int key = 0;
    for (int axis = 2; axis >= 0; axis--) {
        Fixed rest, position = narrowed<T>(task.positions[3 * row + axis]);
        key = key * task.bins[axis] + cell_of(position, task.grid[axis], &rest) / BIN;
    }
    task.keys[row] = key;
    atomicAdd(task.bin_starts + key, 1);
}

// Rows of the particles by bin, in any order within a bin.
static __device__ void scatter(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    int key = task.keys[row];
    task.unsorted[task.bin_starts[key] + atomicAdd(task.bin_cursors + key, 1)] = row;
}

// The same by rows within a bin, whatever the order of threads was.
template <typename T> __device__ void order_particles(const Task &task)
{
    typedef typename Precision<T>::Fixed Fixed;
    int any = thread_index();
    if (any >= task.particles) return;
    int row = task.unsorted[any], key = task.keys[row], place = task.bin_starts[key];
    for (int other = task.bin_starts[key]; other < task.bin_starts[key + 1]; other++)
        if (task.unsorted[other] < row) place++;
    Fixed *to = (Fixed *)task.sorted_positions + 3 * place;
    for (int axis = 0; axis < 3; axis++) to[axis] = narrowed<T>(task.positions[3 * row + axis]);
    task.rows[place] = row;
    task.sorted_classes[place] = task.classes[row];
}

static constexpr int SCAN = 256;

// Exclusive sums of each block of a list, and the sums of the blocks.
static __device__ void sum_blocks(const Task &task)
{
    SHARED(int, sums, SCAN);
    int index = thread_index(), thread = (int)threadIdx.x;
    int own = index < task.scan_count ? task.scanned[index] : 0;
    sums[thread] = own;
    __syncthreads();
    for (int step = 1; step < SCAN; step *= 2) {
        int before = thread >= step ? sums[thread - step] : 0;
        __syncthreads();
        sums[thread] += before;
        __syncthreads();
    }
    if (index < task.scan_count) task.scanned[index] = sums[thread] - own;
    if (thread == SCAN - 1) task.scan_totals[blockIdx.x] = sums[thread];
}

// Adds the sums of the blocks before each block.
static __device__ void add_totals(const Task &task)
{
    int index = thread_index();
    if (index < task.scan_count) task.scanned[index] += task.scan_totals[blockIdx.x];
}
