// Spreading of loads to the grid, by tiles that own their points.
#pragma once
#include "window.h"

// Adds a derivative of a load to the coefficients, and those of its Laplacian as far as the order goes.
template <typename T, int ORDER>
__device__ void add_derivative(T *coefficients, int n, int m, int l, T load, const T *smoothing)
{
    coefficients[3 * term_index<ORDER>(n, m, l)] += load;
    if (n + m + l + 2 > ORDER) return;
    for (int s = 0; s < SECONDS; s++) {
        int at = term_index<ORDER>(n + second_order(s, 0), m + second_order(s, 1), l + second_order(s, 2));
        coefficients[3 * at] += smoothing[s] * load;
    }
}

// Coefficients of a component of a particle's load by products of derivatives; those of a component are three apart.
template <typename T, int ORDER>
__device__ void load_coefficients(const Task &task, int place, int component, T *coefficients)
{
    for (int term = 0; term < terms_of(ORDER); term++) coefficients[3 * term] = 0;
    const T *record = (const T *)task.records + 12 * place;
    add_derivative<T, ORDER>(coefficients, 0, 0, 0, record[component], smoothing_of<T>(task, place, 0));
    if (ORDER > 0) {
        const T *g = record + 3 + 3 * component, *smoothing = smoothing_of<T>(task, place, 1);
        const Numbers &box = *task.numbers;
        T x = (g[0] - (T)box.strain * g[1] - (T)box.tilt_across * g[2]) * (T)box.inverse_spacing[0];
        T y = (g[1] - (T)box.tilt_y * g[2]) * (T)box.inverse_spacing[1];
        T z = g[2] * (T)box.inverse_spacing[2];
        add_derivative<T, ORDER>(coefficients, 1, 0, 0, x, smoothing);
        add_derivative<T, ORDER>(coefficients, 0, 1, 0, y, smoothing);
        add_derivative<T, ORDER>(coefficients, 0, 0, 1, z, smoothing);
    }
}

// Particles that a tile processes at once, threads of a tile, and most bins around it along an axis.
static constexpr int BATCH = 16;
static constexpr int TILE_THREADS = TILE * TILE;
static constexpr int AXIS_BINS = 10;

// Bins along an axis of particles whose stencils may touch a tile. Returns their number.
static __device__ int bins_of_tile(const Task &task, int axis, int origin, int *bins)
{
    int period = task.grid[axis], half = task.points / 2, count = 0;
    int low = origin - task.points + half, high = origin + TILE - 1 + half;
    if (high - low + 1 >= period) {
        for (int bin = 0; bin < task.bins[axis]; bin++) bins[count++] = bin;
        return count;
    }
    for (int point = low; point <= high;) {
        int inside = wrapped(point, period), bin = inside / BIN, end = (bin + 1) * BIN;
        bins[count++] = bin;
        point += (end < period ? end : period) - inside;
    }
    // Both ends may be in one bin.
    return count > 1 && bins[count - 1] == bins[0] ? count - 1 : count;
}

// Values of the window and its derivatives at the points of a tile along an axis, [derivative][point]. Returns the
// points that the stencil touches, one bit each.
template <typename T, int ORDER>
__device__ int tile_weights(const Task &task, int place, int axis, int origin, T *weights)
{
    int period = task.grid[axis], touched = 0;
    AxisStencil<T> stencil = axis_stencil<T>(task, place, axis);
    for (int q = 0; q < TILE; q++) {
        for (int derivative = 0; derivative <= ORDER; derivative++) weights[derivative * TILE + q] = 0;
        if (origin + q >= period) continue;
        for (int point = wrapped(origin + q - stencil.first, period); point < task.points; point += period) {
            touched |= 1 << q;
            for (int derivative = 0; derivative <= ORDER; derivative++)
                weights[derivative * TILE + q] += window_value<T>(task, derivative, point, stencil.argument);
        }
    }
    return touched;
}

// Adds a particle's load to a row of a tile along x.
template <typename T, int ORDER>
__device__ void add_to_row(const T *coefficients, const T *x, const T *y, const T *z, T sums[3][TILE])
{
    T products[pairs_of(ORDER)];
    int pair = 0;
    for (int m = 0; m <= ORDER; m++)
        for (int l = 0; l <= ORDER - m; l++) products[pair++] = y[m * TILE] * z[l * TILE];
    for (int c = 0; c < 3; c++) {
        int term = 0;
        for (int n = 0; n <= ORDER; n++) {
            T factor = 0;
            int first = 0;
            for (int m = 0; m <= ORDER - n; m++) {
                for (int l = 0; l <= ORDER - n - m; l++) factor += coefficients[3 * term++ + c] * products[first + l];
                first += ORDER + 1 - m;
            }
            for (int q = 0; q < TILE; q++) sums[c][q] += factor * x[n * TILE + q];
        }
    }
}

// First particle of each bin around a tile, and the number of particles in the bins before it.
struct TileBins {
    int *starts, *before, count;
};

static __device__ void collect_bins(const Task &task, const int *axis_bins, const int counts[3], TileBins *bins)
{
    for (int bin = (int)threadIdx.x; bin < bins->count; bin += TILE_THREADS) {
        int x = axis_bins[bin % counts[0]], y = axis_bins[AXIS_BINS + bin / counts[0] % counts[1]];
        int z = axis_bins[2 * AXIS_BINS + bin / (counts[0] * counts[1])];
        int key = (z * task.bins[1] + y) * task.bins[0] + x;
        bins->starts[bin] = task.bin_starts[key];
        bins->before[bin + 1] = task.bin_starts[key + 1] - task.bin_starts[key];
    }
    __syncthreads();
    if (threadIdx.x == 0) {
        bins->before[0] = 0;
        for (int bin = 0; bin < bins->count; bin++) bins->before[bin + 1] += bins->before[bin];
    }
    __syncthreads();
}

// Place of the candidate of a given number.
static __device__ int place_of(const TileBins &bins, int candidate)
{
    int low = 0, high = bins.count;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (bins.before[middle] <= candidate) low = middle;
        else high = middle;
    }
    return bins.starts[low] + candidate - bins.before[low];
}

// A block of threads for each tile, a thread for each of its rows along x. Each value is a sum over the particles in
// their order, so it has the same bits in any order of threads.
template <typename T, int ORDER> __device__ void spread(const Task &task)
{
    constexpr int WEIGHTS = (ORDER + 1) * TILE;
    constexpr int TERMS = 3 * terms_of(ORDER);
    SHARED(int, axis_bins, 3 * AXIS_BINS);
    SHARED(int, counts, 3);
    SHARED(int, starts, AXIS_BINS *AXIS_BINS *AXIS_BINS);
    SHARED(int, before, AXIS_BINS *AXIS_BINS *AXIS_BINS + 1);
    SHARED(T, weights, BATCH * 3 * WEIGHTS);
    SHARED(T, coefficients, BATCH *TERMS);
    SHARED(int, touched, BATCH * 3);
    int thread = (int)threadIdx.x, tile = (int)blockIdx.x, origin[3];
    origin[0] = tile % task.tiles[0] * TILE;
    origin[1] = tile / task.tiles[0] % task.tiles[1] * TILE;
    origin[2] = task.first_plane + tile / (task.tiles[0] * task.tiles[1]) * TILE;
    if (thread < 3) counts[thread] = bins_of_tile(task, thread, origin[thread], axis_bins + thread * AXIS_BINS);
    __syncthreads();
    TileBins bins = {starts, before, counts[0] * counts[1] * counts[2]};
    collect_bins(task, axis_bins, counts, &bins);
    int total = before[bins.count], row_y = thread % TILE, row_z = thread / TILE;
    T sums[3][TILE];
    for (int c = 0; c < 3; c++)
        for (int q = 0; q < TILE; q++) sums[c][q] = 0;
    for (int base = 0; base < total; base += BATCH) {
        int member = thread / 4, part = thread % 4, batch = total - base < BATCH ? total - base : BATCH;
        if (member < batch) {
            int place = place_of(bins, base + member);
            if (part < 3) {
                T *to = weights + (3 * member + part) * WEIGHTS;
                touched[3 * member + part] = tile_weights<T, ORDER>(task, place, part, origin[part], to);
            } else {
                for (int c = 0; c < 3; c++)
                    load_coefficients<T, ORDER>(task, place, c, coefficients + member * TERMS + c);
            }
        }
        __syncthreads();
        for (int b = 0; b < batch; b++) {
            const int *masks = touched + 3 * b;
            if (!masks[0] || !(masks[1] >> row_y & 1) || !(masks[2] >> row_z & 1)) continue;
            const T *x = weights + 3 * b * WEIGHTS;
            add_to_row<T, ORDER>(coefficients + b * TERMS, x, x + WEIGHTS + row_y, x + 2 * WEIGHTS + row_z, sums);
        }
        __syncthreads();
    }
    int y = origin[1] + row_y, z = origin[2] - task.first_plane + row_z;
    if (y >= task.grid[1] || z >= task.planes) return;
    long long plane = (long long)task.grid[0] * task.grid[1], row = z * plane + (long long)y * task.grid[0] + origin[0];
    for (int c = 0; c < 3; c++)
        for (int q = 0; q < TILE && origin[0] + q < task.grid[0]; q++)
            ((T *)task.field)[c * plane * task.planes + row + q] = sums[c][q];
}
