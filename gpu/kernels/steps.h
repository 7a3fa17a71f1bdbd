// Measures of displacements of particles that move on the device, and of their near pairs. Lists are in the order of the
// particles' ids, and all numbers in the units of the host.
#pragma once
#include "displace.h"
#include "neighbours.h"

// Columns of which a displacement is a weighted sum, and different weights, at most.
static constexpr int STEP_COLUMNS = 4;
static constexpr int STEP_ORDERS = 4;

// Largest numbers of all particles or pairs, see in_order(); 0 without any. `nearest` is that of minus the gaps.
struct StepSums {
    unsigned long long error, roughness, loss, nearest;
};

// gpu/src/steps.rs has the same fields in the same order.
struct StepMotion {
    // Radii by class; positions; columns of velocities, or 0.
    const double *radii, *positions, *columns[STEP_COLUMNS];
    StepSums *sums;
    // Numbers of spheres that have been pushed in each of some rounds.
    unsigned long long *pushed;
    double weights[STEP_ORDERS][STEP_COLUMNS];
    // Velocity gradient of the flow by rows.
    double gradient[9];
    // Deformation of separations, after displacements, by the flow, by rows.
    double deformation[9];
    // Ratios of differences between orders up to which a motion counts as smooth.
    double smooth[2];
    // Gaps over the mean radius, as which smaller ones count in losses and in errors.
    double least[2];
    // Distance of centres up to which pairs count; unit of length over that of the far field.
    double reach, length;
    // Gap of spheres that are moved apart, over the mean radius, and its relative tolerance.
    double closest, slack;
};

// Integers in the order of numbers, none of which is 0; NaN comes last.
static __device__ unsigned long long in_order(double value)
{
    if (value != value) return ~0ull;
    unsigned long long bits = (unsigned long long)__double_as_longlong(value);
    return bits >> 63 ? ~bits : bits | 1ull << 63;
}

// Raises a maximum that all threads share.
static __device__ void raise_to(unsigned long long *most, unsigned long long own)
{
    if (own > *(volatile unsigned long long *)most) atomicMax(most, own);
}

static __device__ double length_of(const double x[3]) { return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]); }

// Weighted sum of columns.
static __device__ void combine_columns(const Task &task)
{
    const StepMotion &step = *task.step;
    long long at = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (at >= task.list_size) return;
    double sum = 0;
    for (int k = 0; k < STEP_COLUMNS && step.columns[k]; k++) sum += step.weights[0][k] * step.columns[k][at];
    ((double *)task.list_y)[at] = sum;
}

// Velocities in the first column plus the first weight times those of the flow at the positions.
static __device__ void add_flow_to_velocities(const Task &task)
{
    const StepMotion &step = *task.step;
    long long row = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (row >= task.list_size) return;
    double flow[3];
    transform_vector(step.gradient, step.positions + 3 * row, flow);
    for (int axis = 0; axis < 3; axis++)
        ((double *)task.list_y)[3 * row + axis] = step.columns[0][3 * row + axis] + step.weights[0][0] * flow[axis];
}

// Vectors of the first column, of which none is longer than the first weight times the radius of its particle.
static __device__ void limit_vectors(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const StepMotion &step = *task.step;
    long long place = 3 * (long long)task.places[row];
    const double *given = step.columns[0] + place;
    double *limited = (double *)task.list_y + place;
    double length = length_of(given), longest = step.weights[0][0] * step.radii[task.classes[row]];
    for (int axis = 0; axis < 3; axis++) limited[axis] = length > longest ? given[axis] * (longest / length) : given[axis];
}

// Error and roughness from the differences between M displacements and the next ones. As on the host, the maximum
// ignores NaN.
template <int M>
__device__ void estimate_error(const StepMotion &step, const double *differences, double *error, double *roughness)
{
    *error = differences[0];
    *roughness = 0;
    if constexpr (M == STEP_ORDERS) {
        double highest = differences[0], stable = differences[1], lower = differences[2];
        bool is_smooth = highest <= fmax(step.smooth[0] * stable, step.smooth[1] * lower);
        *error = is_smooth ? fmax(stable, 0.25 * highest) : stable;
        *roughness = is_smooth ? 0 : highest;
    }
}

// Largest error and roughness of displacements over the radius, from weights of the differences between M displacements
// and the next ones.
template <int M> __device__ void measure_displacements(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const StepMotion &step = *task.step;
    long long place = 3 * (long long)task.places[row];
    double differences[M - 1], error, roughness;
    for (int order = 0; order < M - 1; order++) {
        double x[3] = {0, 0, 0};
        for (int k = 0; k < STEP_COLUMNS && step.columns[k]; k++)
            for (int axis = 0; axis < 3; axis++) x[axis] += step.columns[k][place + axis] * step.weights[order][k];
        differences[order] = length_of(x) / step.radii[task.classes[row]];
    }
    estimate_error<M>(step, differences, &error, &roughness);
    if (!(error <= 0)) raise_to(&step.sums->error, in_order(error));
    if (!(roughness <= 0)) raise_to(&step.sums->roughness, in_order(roughness));
}

// A sphere and a periodic image of another, or of itself: places of their numbers in lists; the vector from the image to
// the sphere along the axes of space; their radii; and whether the sphere is the one with the larger row, or the same.
struct StepPair {
    long long own, other;
    double x[3], distance, radii[2];
    bool is_second;

    __device__ double contact() const { return radii[0] + radii[1]; }
};

// Calls a function with each pair of a particle whose centres are within the reach.
template <typename T, typename Visit> __device__ void visit_near(const Task &task, int target, const Visit &visit)
{
    const StepMotion &step = *task.step;
    int row = task.rows[target];
    StepPair pair;
    pair.own = 3 * (long long)task.places[row];
    pair.radii[0] = step.radii[task.classes[row]];
    auto find = [&](int source, const int steps[3]) {
        int other = task.rows[source];
        const unsigned long long *positions = task.positions;
        double along[3];
        separation_of<double>(task, positions + 3 * row, positions + 3 * other, steps, along);
        turn_to_space(task, along, pair.x);
        for (int axis = 0; axis < 3; axis++) pair.x[axis] *= step.length;
        pair.distance = length_of(pair.x);
        if (!(pair.distance < step.reach)) return;
        pair.other = 3 * (long long)task.places[other];
        pair.radii[1] = step.radii[task.classes[other]];
        pair.is_second = other <= row;
        visit(pair);
    };
    visit_around<T>(task, target, task.near_reach, find);
}

// Velocity of the flow across the lattice vector from the other sphere of a pair to its image; there is none in boxes with
// tilts. Without walls, positions differ from those of the far field by lattice vectors alone.
static __device__ void velocity_of_image(const Task &task, const StepPair &pair, double velocity[3])
{
    const StepMotion &step = *task.step;
    const Numbers &box = *task.numbers;
    double vector[3];
    for (int axis = 0; axis < 3; axis++)
        vector[axis] = step.positions[pair.own + axis] - pair.x[axis] - step.positions[pair.other + axis];
    vector[0] -= box.strain * vector[1];
    for (int axis = 0; axis < 3; axis++) {
        double edge = box.edges[axis] * step.length;
        vector[axis] = rint(vector[axis] / edge) * edge;
    }
    vector[0] += box.strain * vector[1];
    transform_vector(step.gradient, vector, velocity);
}

// Vectors of a pair after displacements by each of M weights, deformed by the flow.
template <int M> __device__ void displace_pair(const Task &task, const StepPair &pair, double after[M][3])
{
    const StepMotion &step = *task.step;
    double of_image[3];
    velocity_of_image(task, pair, of_image);
    for (int order = 0; order < M; order++)
        for (int axis = 0; axis < 3; axis++) after[order][axis] = pair.x[axis];
    for (int k = 0; k < STEP_COLUMNS && step.columns[k]; k++) {
        const double *own = step.columns[k] + pair.own, *other = step.columns[k] + pair.other;
        for (int axis = 0; axis < 3; axis++) {
            double velocity = own[axis] - other[axis] - of_image[axis];
            for (int order = 0; order < M; order++) after[order][axis] += velocity * step.weights[order][k];
        }
    }
    for (int order = 0; order < M; order++) {
        double displaced[3] = {after[order][0], after[order][1], after[order][2]};
        transform_vector(step.deformation, displaced, after[order]);
    }
}

// Changes of the gaps of all pairs, each of which counts once: for M = 2 after the first displacement, with the
// difference from the second as an error; for M = 4 see estimate_error().
template <typename T, int M> __device__ void change_gaps(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    const StepMotion &step = *task.step;
    double loss = 0, error = 0, roughness = 0;
    unsigned long long nearest = 0;
    auto visit = [&](const StepPair &pair) {
        if (!pair.is_second) return;
        double gap = pair.distance - pair.contact(), mean = 0.5 * pair.contact(), after[M][3], gaps[M];
        unsigned long long closeness = in_order(-gap);
        if (closeness > nearest) nearest = closeness;
        double sizes[2] = {fmax(gap, step.least[0] * mean), fmax(gap, step.least[1] * mean)};
        if (!(sizes[0] > 0)) return;
        displace_pair<M>(task, pair, after);
        double differences[M - 1], of_pair, rough;
        for (int order = 0; order < M; order++) gaps[order] = length_of(after[order]) - pair.contact();
        for (int order = 0; order < M - 1; order++) differences[order] = fabs(gaps[order] - gaps[order + 1]);
        estimate_error<M>(step, differences, &of_pair, &rough);
        loss = fmax(loss, (gap - gaps[M == STEP_ORDERS ? 1 : 0]) / sizes[0]);
        error = fmax(error, of_pair / sizes[1]);
        roughness = fmax(roughness, rough / sizes[1]);
    };
    visit_near<T>(task, target, visit);
    raise_to(&step.sums->nearest, nearest);
    if (loss > 0) raise_to(&step.sums->loss, in_order(loss));
    if (error > 0) raise_to(&step.sums->error, in_order(error));
    if (roughness > 0) raise_to(&step.sums->roughness, in_order(roughness));
}

// Smallest gap over the mean radius, of which minus is stored.
template <typename T> __device__ void find_nearest(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    unsigned long long nearest = 0;
    auto visit = [&](const StepPair &pair) {
        unsigned long long closeness = in_order((pair.contact() - pair.distance) / (0.5 * pair.contact()));
        if (closeness > nearest) nearest = closeness;
    };
    visit_near<T>(task, target, visit);
    raise_to(&task.step->sums->nearest, nearest);
}

// A round in which spheres that are too close after a displacement are moved apart along their lines of centres, the
// smaller one farther, and a sphere of several such pairs by their mean: displacements so far, or 0, become those after
// it. Counts the spheres that move. `list_size` is the number of the round among those whose spheres are counted; after
// one in which none have moved, displacements stay as they are.
template <typename T> __device__ void push_apart(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    const StepMotion &step = *task.step;
    const double *before = (const double *)task.list_x;
    unsigned long long *pushed = step.pushed + task.list_size;
    long long place = 3 * (long long)task.places[task.rows[target]];
    double sum[3] = {0, 0, 0}, pairs = 0;
    auto visit = [&](const StepPair &pair) {
        double after[1][3], *x = after[0];
        displace_pair<1>(task, pair, after);
        for (int axis = 0; before && axis < 3; axis++) x[axis] += before[pair.own + axis] - before[pair.other + axis];
        double distance = length_of(x), gap = step.closest * 0.5 * pair.contact();
        double missing = gap + pair.contact() - distance;
        if (missing <= step.slack * gap) return;
        double share = missing * pair.radii[1] / pair.contact();
        pairs++;
        // Spheres with coincident centres are moved apart along x.
        if (!(distance > 0)) sum[0] += pair.is_second ? share : -share;
        for (int axis = 0; distance > 0 && axis < 3; axis++) sum[axis] += x[axis] * (share / distance);
    };
    if (task.list_size == 0 || pushed[-1] > 0) visit_near<T>(task, target, visit);
    for (int axis = 0; axis < 3; axis++) {
        double so_far = before ? before[place + axis] : 0;
        ((double *)task.list_y)[place + axis] = pairs > 0 ? so_far + sum[axis] / pairs : so_far;
    }
    if (pairs > 0) atomicAdd(pushed, 1ull);
}
