// Stokes solve in Fourier space.
#pragma once
#include "bins.h"

static __device__ float exponential(float x) { return expf(x); }
static __device__ double exponential(double x) { return exp(x); }

// Multiplies each mode by `factor (I - k k/k^2)/k^2` times the Gaussian, its bracket, and the inverse transforms of the
// window. The mean and the Nyquist mode of each axis are zero.
template <typename T> __device__ void solve(const Task &task)
{
    int columns = task.grid[0] / 2 + 1, rows = task.grid[1], planes = task.grid[2], at = thread_index();
    if (at >= columns * rows * planes) return;
    int modes[3] = {at % columns, at / columns % rows, at / (columns * rows)};
    const T *levels = (const T *)task.levels;
    T k[3], level = levels[modes[0]] + levels[columns + modes[1]] + levels[columns + rows + modes[2]];
    bool is_zero = modes[0] == 0 && modes[1] == 0 && modes[2] == 0;
    for (int axis = 0; axis < 3; axis++) {
        int order = 2 * modes[axis] < task.grid[axis] ? modes[axis] : modes[axis] - task.grid[axis];
        k[axis] = (T)(6.283185307179586 * order / task.edges[axis]);
        is_zero = is_zero || 2 * modes[axis] == task.grid[axis];
    }
    k[2] -= (T)task.tilt_y * k[1] + (T)task.tilt_across * k[0];
    k[1] -= (T)task.strain * k[0];
    T square = k[0] * k[0] + k[1] * k[1] + k[2] * k[2], inverse = is_zero ? (T)0 : 1 / square;
    T bracket = 1 + (T)task.widening * square;
    T gaussian = is_zero ? (T)0 : exponential(level - (T)task.gaussian * square);
    T factor = (T)task.solve_factor * gaussian * bracket * bracket * inverse;
    Complex<T> *spectrum = (Complex<T> *)task.spectrum;
    long long stride = (long long)columns * rows * planes;
    Complex<T> f[3] = {spectrum[at], spectrum[at + stride], spectrum[at + 2 * stride]};
    T re = (k[0] * f[0].re + k[1] * f[1].re + k[2] * f[2].re) * inverse;
    T im = (k[0] * f[0].im + k[1] * f[1].im + k[2] * f[2].im) * inverse;
    for (int c = 0; c < 3; c++) {
        Complex<T> u = {factor * (f[c].re - k[c] * re), factor * (f[c].im - k[c] * im)};
        spectrum[at + c * stride] = u;
    }
}
