// Modes that devices exchange between transforms of planes and of columns.
#pragma once
#include "bins.h"

// Layouts of the modes, [component][z][m2][m1]: planes of a device with all modes, which go to other devices by m2; and
// columns of a device with all planes, which go by z.
static constexpr int PLANE = 0, COLUMN = 1;

// Moves modes to the list of those that devices exchange, in the memory of the field, or back. The list has a part for
// each device, [component][z][m2][m1], that of this device first and those of the following devices in turn.
template <typename T, int LAYOUT, bool PACKS> __device__ void move_modes(const Task &task)
{
    int columns = task.grid[0] / 2 + 1, at = thread_index();
    int extents[2] = {task.modes, task.grid[2]};
    if (LAYOUT == PLANE) extents[0] = task.grid[1], extents[1] = task.planes;
    long long count = (long long)columns * extents[0] * extents[1];
    if (at >= count) return;
    int lines[2] = {at / columns % extents[0], at / (columns * extents[0])};
    const int *part = task.parts[LAYOUT] + 2 * lines[LAYOUT];
    int start = part[0], own = LAYOUT == PLANE ? task.first_mode : task.first_plane;
    long long before = 3LL * extents[1 - LAYOUT] * wrapped(start - own, task.grid[1 + LAYOUT]);
    lines[LAYOUT] -= start;
    extents[LAYOUT] = part[1];
    for (int c = 0; c < 3; c++) {
        long long row = before + ((long long)c * extents[1] + lines[1]) * extents[0] + lines[0];
        Complex<T> *listed = (Complex<T> *)task.field + row * columns + at % columns;
        Complex<T> *place = (Complex<T> *)task.spectrum + c * count + at;
        if (PACKS) *listed = *place;
        else *place = *listed;
    }
}

template <typename T, int LAYOUT> __device__ void pack(const Task &task) { move_modes<T, LAYOUT, true>(task); }
template <typename T, int LAYOUT> __device__ void unpack(const Task &task) { move_modes<T, LAYOUT, false>(task); }
