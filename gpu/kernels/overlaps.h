// Pairs of spheres that overlap, or nearly.
#pragma once
#include "neighbours.h"

// Pairs, each of which counts for both of its spheres: those that overlap, and those below the minimum gap; and the bits
// of the deepest overlap, which are ordered as positive numbers are.
struct OverlapSums {
    unsigned long long overlapping, at_minimum_gap, depth;
};

// Adds up the pairs of each particle, by the distances of centres at contact and at the minimum gap for two classes of
// radius.
template <typename T> __device__ void count_overlaps(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    int row = task.rows[target];
    const double *of_row = (const double *)task.list_x + 2 * task.class_count * task.classes[row];
    unsigned long long overlapping = 0, at_minimum_gap = 0;
    double depth = 0;
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source];
        const unsigned long long *positions = task.positions;
        double x[3];
        separation_of<double>(task, positions + 3 * row, positions + 3 * other, steps, x);
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
        const double *limits = of_row + 2 * task.classes[other];
        if (distance < limits[1]) at_minimum_gap++;
        if (distance >= limits[0]) return;
        overlapping++;
        if (limits[0] - distance > depth) depth = limits[0] - distance;
    };
    visit_around<T>(task, target, task.near_reach, visit);
    OverlapSums *sums = (OverlapSums *)task.list_y;
    if (at_minimum_gap > 0) atomicAdd(&sums->at_minimum_gap, at_minimum_gap);
    if (overlapping == 0) return;
    atomicAdd(&sums->overlapping, overlapping);
    atomicMax(&sums->depth, (unsigned long long)__double_as_longlong(depth));
}
