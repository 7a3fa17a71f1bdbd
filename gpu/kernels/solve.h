// Stokes solve in Fourier space.
#pragma once
#include "bins.h"

static __device__ float exponential(float x) { return expf(x); }
static __device__ double exponential(double x) { return exp(x); }

// Number of modes of a component, in whole columns along z.
static __device__ long long modes_of(const Task &task)
{
    return (long long)(task.grid[0] / 2 + 1) * task.modes * task.grid[2];
}

// Signed index along an axis of a mode by its place.
static __device__ int signed_mode(const Task &task, int at, int axis)
{
    int columns = task.grid[0] / 2 + 1, rows = task.modes;
    int mode = axis == 0 ? at % columns : axis == 1 ? task.first_mode + at / columns % rows : at / (columns * rows);
    return 2 * mode < task.grid[axis] ? mode : mode - task.grid[axis];
}

// Wavevector of a mode, the inverse of its square, and the multiplier of the solve: `factor / k^2` times the Gaussian,
// its bracket, and the inverse transforms of the window. The mean and the Nyquist mode of each axis are zero.
template <typename T> struct Mode {
    T k[3], inverse, factor;
};

template <typename T> __device__ Mode<T> mode_at(const Task &task, int at)
{
    const Numbers &box = *task.numbers;
    const T *levels = (const T *)task.levels;
    T level = 0;
    Mode<T> mode;
    bool is_zero = at == 0 && task.first_mode == 0;
    for (int axis = 0; axis < 3; axis++) {
        int order = signed_mode(task, at, axis), place = order < 0 && axis > 0 ? order + task.grid[axis] : abs(order);
        level += levels[place];
        levels += axis == 0 ? task.grid[0] / 2 + 1 : task.grid[axis];
        mode.k[axis] = (T)(6.283185307179586 * order / box.edges[axis]);
        is_zero = is_zero || 2 * abs(order) == task.grid[axis];
    }
    T *k = mode.k;
    k[2] -= (T)box.tilt_y * k[1] + (T)box.tilt_across * k[0];
    k[1] -= (T)box.strain * k[0];
    T square = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
    T bracket = 1 + (T)task.widening * square;
    T gaussian = is_zero ? (T)0 : exponential(level - (T)task.gaussian * square);
    mode.inverse = is_zero ? (T)0 : 1 / square;
    mode.factor = (T)box.solve_factor * gaussian * bracket * bracket * mode.inverse;
    return mode;
}

// Stores a mode of a field, `factor (I - k k/k^2) f`.
template <typename T> __device__ void store_across(const Task &task, int at, const Mode<T> &mode, T factor, Complex<T> f[3])
{
    const T *k = mode.k;
    T re = (k[0] * f[0].re + k[1] * f[1].re + k[2] * f[2].re) * mode.inverse;
    T im = (k[0] * f[0].im + k[1] * f[1].im + k[2] * f[2].im) * mode.inverse;
    for (int c = 0; c < 3; c++)
        ((Complex<T> *)task.spectrum)[at + c * modes_of(task)] = {factor * (f[c].re - k[c] * re),
                                                                  factor * (f[c].im - k[c] * im)};
}

// Multiplies each mode by the Green's function.
template <typename T> __device__ void solve(const Task &task)
{
    int at = thread_index();
    if (at >= modes_of(task)) return;
    const Complex<T> *spectrum = (const Complex<T> *)task.spectrum;
    Complex<T> f[3];
    for (int c = 0; c < 3; c++) f[c] = spectrum[at + c * modes_of(task)];
    Mode<T> mode = mode_at<T>(task, at);
    store_across<T>(task, at, mode, mode.factor, f);
}

// Place of a mode up to half the points along each axis, the highest along x left out, in a list [m3][m2][m1].
static __device__ long long place_of_octant(const Task &task, const int mode[3])
{
    return ((long long)mode[2] * (task.grid[1] / 2 + 1) + mode[1]) * (task.grid[0] / 2) + mode[0];
}

// Multiplies each mode by the kernel of unbounded fluid, a symmetric tensor whose entries xx, xy, xz, yy, yz and zz are
// lists by modes. It is even along each axis but for the entries that couple this axis with another, which are odd.
// The highest mode of x becomes zero. Forces and velocities are in the first half of the grid along each axis.
template <typename T> __device__ void solve_open(const Task &task)
{
    int at = thread_index(), mode[3];
    if (at >= modes_of(task)) return;
    T sign[3];
    for (int axis = 0; axis < 3; axis++) {
        int order = signed_mode(task, at, axis);
        sign[axis] = order < 0 ? -1 : 1;
        mode[axis] = abs(order);
    }
    bool is_kept = 2 * mode[0] < task.grid[0];
    long long count = (long long)(task.grid[0] / 2) * (task.grid[1] / 2 + 1) * (task.grid[2] / 2 + 1);
    const T *entries = (const T *)task.free_kernel + (is_kept ? place_of_octant(task, mode) : 0);
    T k[6];
    for (int entry = 0; entry < 6; entry++) k[entry] = is_kept ? entries[entry * count] : (T)0;
    k[1] *= sign[1], k[2] *= sign[2], k[4] *= sign[1] * sign[2];
    const T rows[3][3] = {{k[0], k[1], k[2]}, {k[1], k[3], k[4]}, {k[2], k[4], k[5]}};
    Complex<T> *spectrum = (Complex<T> *)task.spectrum + at, f[3];
    for (int c = 0; c < 3; c++) f[c] = spectrum[c * modes_of(task)];
    for (int c = 0; c < 3; c++)
        spectrum[c * modes_of(task)] = {rows[c][0] * f[0].re + rows[c][1] * f[1].re + rows[c][2] * f[2].re,
                                        rows[c][0] * f[0].im + rows[c][1] * f[1].im + rows[c][2] * f[2].im};
}
