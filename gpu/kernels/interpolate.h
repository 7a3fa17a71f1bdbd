// Interpolation of the grid's velocities to the particles: the adjoint of spreading.
#pragma once
#include "window.h"

static constexpr int INTERPOLATION_THREADS = 128;
static constexpr int MOST_POINTS = 16;
static constexpr int MOTION = 12;

// Sums of a derivative of the window along x over the sums of its row, with those of its Laplacian as far as the order
// goes.
template <typename T, int ORDER>
__device__ T smoothed(const T *x, const T sums[][3], int n, int m, int l, int component, const T *smoothing)
{
    T total = x[n * MOST_POINTS] * sums[pairs_of(ORDER) - pairs_of(ORDER - m) + l][component];
    if (n + m + l + 2 > ORDER) return total;
    for (int s = 0; s < SECONDS; s++) {
        int dn = n + second_order(s, 0), dm = m + second_order(s, 1), dl = l + second_order(s, 2);
        total += smoothing[s] * x[dn * MOST_POINTS] * sums[pairs_of(ORDER) - pairs_of(ORDER - dm) + dl][component];
    }
    return total;
}

// Sums over a column of a stencil, the points of equal x in the planes that this device has, by pairs of derivatives
// along y and z.
template <typename T, int ORDER>
__device__ void column_sums(const Task &task, const int first[3], int x, const T *y, const T *z, T sums[][3])
{
    long long plane = (long long)task.grid[0] * task.grid[1];
    const T *field = (const T *)task.field + wrapped(first[0] + x, task.grid[0]);
    for (int pair = 0; pair < pairs_of(ORDER); pair++)
        for (int c = 0; c < 3; c++) sums[pair][c] = 0;
    for (int dz = 0; dz < task.points; dz++) {
        int at = wrapped(first[2] + dz - task.first_plane, task.grid[2]);
        if (at >= task.planes) continue;
        T of_plane[ORDER + 1][3];
        for (int m = 0; m <= ORDER; m++)
            for (int c = 0; c < 3; c++) of_plane[m][c] = 0;
        for (int dy = 0; dy < task.points; dy++) {
            const T *value = field + (long long)wrapped(first[1] + dy, task.grid[1]) * task.grid[0] + at * plane;
            for (int c = 0; c < 3; c++)
                for (int m = 0; m <= ORDER; m++)
                    of_plane[m][c] += y[m * MOST_POINTS + dy] * value[c * plane * task.planes];
        }
        int pair = 0;
        for (int m = 0; m <= ORDER; m++)
            for (int l = 0; l <= ORDER - m; l++, pair++)
                for (int c = 0; c < 3; c++) sums[pair][c] += of_plane[m][c] * z[l * MOST_POINTS + dz];
    }
}

// Velocity and derivatives along the lattice of each particle; a thread for each point of a stencil along x.
template <typename T, int ORDER> __device__ void interpolate(const Task &task)
{
    constexpr int AXIS = (ORDER + 1) * MOST_POINTS;
    SHARED(T, weights, INTERPOLATION_THREADS / 8 * 3 * AXIS);
    SHARED(T, partial, MOTION *INTERPOLATION_THREADS);
    int thread = (int)threadIdx.x, lane = thread % task.lanes, group = thread / task.lanes;
    int place = (int)blockIdx.x * (INTERPOLATION_THREADS / task.lanes) + group, first[3] = {0, 0, 0};
    bool is_point = place < task.particles && lane < task.points;
    T *own = weights + group * 3 * AXIS;
    if (is_point)
        for (int axis = 0; axis < 3; axis++) {
            AxisStencil<T> stencil = axis_stencil<T>(task, place, axis);
            first[axis] = stencil.first;
            for (int derivative = 0; derivative <= ORDER; derivative++)
                own[axis * AXIS + derivative * MOST_POINTS + lane] =
                    window_value<T>(task, derivative, lane, stencil.argument);
        }
    __syncthreads();
    if (is_point) {
        T sums[pairs_of(ORDER)][3];
        column_sums<T, ORDER>(task, first, lane, own + AXIS, own + 2 * AXIS, sums);
        const T *x = own + lane, *of_force = smoothing_of<T>(task, place, 0), *of_dipole = smoothing_of<T>(task, place, 1);
        for (int c = 0; c < 3; c++) {
            T *to = partial + c * INTERPOLATION_THREADS + thread;
            to[0] = smoothed<T, ORDER>(x, sums, 0, 0, 0, c, of_force);
            for (int axis = 0; ORDER > 0 && axis < 3; axis++)
                to[3 * (axis + 1) * INTERPOLATION_THREADS] =
                    smoothed<T, ORDER>(x, sums, axis == 0, axis == 1, axis == 2, c, of_dipole);
        }
    }
    __syncthreads();
    if (place >= task.particles) return;
    for (int value = lane; value < MOTION; value += task.lanes) {
        T sum = 0;
        for (int point = 0; (ORDER > 0 || value < 3) && point < task.points; point++)
            sum += partial[value * INTERPOLATION_THREADS + group * task.lanes + point];
        ((T *)task.interpolated)[MOTION * place + value] = sum;
    }
}
