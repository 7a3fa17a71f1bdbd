// Images of particles in walls, in wavenumbers that are not on the grid: fcm/src/walls/wall_images.rs lists them.
#pragma once
#include "loads.h"
#include "pairs.h"

static constexpr int IMAGE_LANES = 8;
static constexpr int IMAGE_THREADS = 128;

// Place in a block of a gradient or dipole, whose columns follow each other, by its place in a list by rows.
static __device__ int block_place(int entry) { return entry < 3 ? entry : 3 + 3 * (entry % 3) + entry / 3 - 1; }

// Adds the motion by an image: a block times the load of a source, or for the second particle of a pair its transpose,
// for which dipoles and gradients have the opposite sign.
template <typename T> __device__ void add_image(const T *block, bool is_forward, const T load[MOTION], T sums[MOTION])
{
    for (int i = 0; i < MOTION; i++) {
        int to = block_place(i);
        T sum = 0;
        for (int j = 0; j < MOTION; j++) {
            int from = block_place(j);
            T entry = is_forward ? block[MOTION * to + from] : block[MOTION * from + to];
            sum += (is_forward || (i < 3) == (j < 3) ? entry : -entry) * load[j];
        }
        sums[i] += sum;
    }
}

// Adds the motions by images to those of the particles, with eight threads each, in the order of the host.
template <typename T> __device__ void image_motions(const Task &task)
{
    SHARED(T, partial, MOTION *IMAGE_THREADS);
    int thread = (int)threadIdx.x, lane = thread % IMAGE_LANES;
    int row = (int)blockIdx.x * (IMAGE_THREADS / IMAGE_LANES) + thread / IMAGE_LANES;
    bool is_there = row < task.owned;
    T sums[MOTION], load[MOTION];
    for (int i = 0; i < MOTION; i++) sums[i] = 0;
    int end = is_there ? task.image_starts[row + 1] : 0;
    for (int entry = is_there ? task.image_starts[row] + lane : 0; entry < end; entry += IMAGE_LANES) {
        int source = task.images[2 * entry], packed = task.images[2 * entry + 1];
        load_of<T>(task, source, load);
        const T *block = (const T *)task.image_blocks + (long long)(packed / 2) * MOTION * MOTION;
        add_image<T>(block, packed % 2 == 1, load, sums);
    }
    for (int i = 0; i < MOTION; i++) partial[i * IMAGE_THREADS + thread] = sums[i];
    __syncthreads();
    if (!is_there || lane > 0) return;
    for (int i = 0; i < MOTION; i++) {
        sums[i] = 0;
        for (int other = 0; other < IMAGE_LANES; other++) sums[i] += partial[i * IMAGE_THREADS + thread + other];
        sums[i] *= (T)task.inverse_viscosity;
    }
    store_motion<T, true>(task, row, sums);
}
