// Forces between the surfaces of near spheres along their lines of centres, in f64.
#pragma once
#include "neighbours.h"

// Laws, in the order of gpu/src/surface_laws.rs.
static constexpr int BARRIER = 0, SCREENED = 1, VAN_DER_WAALS = 2;

// A law for two classes of radius, with the fields of gpu/src/surface_laws.rs in the same order: which it is, the
// distances of the centres where it ends and at contact, and its numbers.
struct SurfacePair {
    long long kind;
    double reach, contact, numbers[3];
};

// Repulsion at a distance of the centres within reach.
static __device__ double repulsion(const SurfacePair &law, double distance)
{
    const double *n = law.numbers, gap = distance - law.contact;
    if (law.kind == BARRIER) {
        double depth = (law.reach * law.reach - distance * distance) / n[1];
        return n[0] * depth * depth * distance;
    }
    if (law.kind == SCREENED) return n[0] * exp(-gap / n[1]);
    if (law.kind == VAN_DER_WAALS) {
        double apart = (gap > 0 ? gap : 0) + n[1];
        return n[0] * (n[2] - 1 / (apart * apart));
    }
    // Depletion: minus the area of the circle in which two exclusion shells intersect.
    double along = (distance * distance + n[1] - n[2]) / (2 * distance), square = n[1] - along * along;
    return square > 0 ? -n[0] * square : 0;
}

// Adds the forces on each particle to the first three of its numbers in `image`, of which it has `list_size`.
template <typename T> __device__ void surface_forces(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    int row = task.rows[target];
    const SurfacePair *of_row = task.surface_laws + task.surface_count * task.class_count * task.classes[row];
    double sum[3] = {0, 0, 0};
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source];
        const unsigned long long *positions = task.positions;
        double x[3];
        separation_of<double>(task, positions + 3 * row, positions + 3 * other, steps, x);
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), force = 0;
        const SurfacePair *laws = of_row + task.surface_count * task.classes[other];
        for (int k = 0; k < task.surface_count; k++)
            if (distance < laws[k].reach) force += repulsion(laws[k], distance);
        for (int axis = 0; force != 0 && axis < 3; axis++) sum[axis] += force * (x[axis] / distance);
    };
    visit_around<T>(task, target, task.surface_reach, visit);
    double *to = task.image + task.list_size * row;
    for (int a = 0; a < 3; a++) {
        const double *turned = task.numbers->axes + 3 * a;
        to[a] += task.is_rotated ? turned[0] * sum[0] + turned[1] * sum[1] + turned[2] * sum[2] : sum[a];
    }
}
