// Forces between the surfaces of near spheres along their lines of centres, in f64.
#pragma once
#include "predicted.h"

// Laws, in the order of gpu/src/surface_laws.rs.
static constexpr int BARRIER = 0, SCREENED = 1, VAN_DER_WAALS = 2;

// A law for two classes of radius, with the fields of gpu/src/surface_laws.rs in the same order: which it is, whether it
// is implicit in predictions, the distances of the centres where it ends and at contact, and its numbers.
struct SurfacePair {
    long long kind, is_implicit;
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

// Decrease of a repulsion with the distance within reach; 0 where it increases, as attractions do.
static __device__ double stiffness(const SurfacePair &law, double distance)
{
    const double *n = law.numbers;
    if (law.kind == BARRIER) {
        double square = distance * distance, depth = (law.reach * law.reach - square) / n[1];
        double slope = 4 * square / n[1] - depth;
        return depth > 0 && slope > 0 ? n[0] * depth * slope : 0;
    }
    return law.kind == SCREENED ? repulsion(law, distance) / n[1] : 0;
}

// Laws of the pairs of two rows.
static __device__ const SurfacePair *laws_of(const Task &task, int row, int other)
{
    return task.surface_laws + task.surface_count * (task.class_count * task.classes[row] + task.classes[other]);
}

// Decrease of the implicit forces of a pair, while it separates with unit velocity, over the time of a prediction.
static __device__ double surface_resistance(const Task &task, int row, int other, double distance)
{
    if (!task.predicted) return 0;
    const SurfacePair *laws = laws_of(task, row, other);
    double sum = 0;
    for (int k = 0; k < task.surface_count; k++)
        if (laws[k].is_implicit && distance < laws[k].reach) sum += stiffness(laws[k], distance);
    return sum * task.predicted->time;
}

// Adds the forces on each particle to the first three of its numbers in `image`, of which it has `list_size`. With a
// prediction the decrease of implicit forces at the predicted velocities is added back.
template <typename T> __device__ void surface_forces(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    int row = task.rows[target];
    double sum[3] = {0, 0, 0}, turned[3];
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source];
        const unsigned long long *positions = task.positions;
        double x[3];
        separation_of<double>(task, positions + 3 * row, positions + 3 * other, steps, x);
        double distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]), force = 0;
        const SurfacePair *laws = laws_of(task, row, other);
        for (int k = 0; k < task.surface_count; k++)
            if (distance < laws[k].reach) force += repulsion(laws[k], distance);
        double resistance = surface_resistance(task, row, other, distance);
        if (resistance > 0) force += resistance * predicted_separation(task, row, other, x, distance);
        for (int axis = 0; force != 0 && axis < 3; axis++) sum[axis] += force * (x[axis] / distance);
    };
    visit_around<T>(task, target, task.surface_reach, visit);
    double *to = task.image + task.list_size * row;
    turn_to_space(task, sum, turned);
    for (int axis = 0; axis < 3; axis++) to[axis] += turned[axis];
}
