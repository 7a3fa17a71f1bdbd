// Particles that move on the device. Lists are in the order of the particles' ids, and in the units of the host.
#pragma once
#include "bins.h"

// Columns of displacements and of velocities at most.
static constexpr int MOST_COLUMNS = 8;

// gpu/src/displace.rs has the same fields in the same order.
struct Displacement {
    // Positions, lattice steps that were taken out of them, columns of displacements and of velocities, and all of these
    // afterwards; absent columns are 0.
    const double *positions, *steps, *terms[MOST_COLUMNS], *velocities[MOST_COLUMNS];
    double *moved, *counted, *carried[MOST_COLUMNS];
    double weights[MOST_COLUMNS];
    // Edges and strain of the box, and the velocity gradient of the flow by rows.
    double edges[3], strain, gradient[9];
    // Distance from the box, in edges, from which on a particle is lost.
    double farthest;
    long long particles, is_lost;
};

// Lattice vector of some steps.
static __device__ void lattice_vector(const Displacement &box, const double steps[3], double x[3])
{
    for (int axis = 0; axis < 3; axis++) x[axis] = steps[axis] * box.edges[axis];
    x[0] += box.strain * x[1];
}

// Whole edges in the lattice coordinates of a position. Returns whether there are any.
static __device__ bool whole_edges(const Displacement &box, const double x[3], double steps[3])
{
    double along[3] = {x[0] - box.strain * x[1], x[1], x[2]};
    for (int axis = 0; axis < 3; axis++) steps[axis] = floor(along[axis] / box.edges[axis]);
    return steps[0] != 0 || steps[1] != 0 || steps[2] != 0;
}

// Image of a position inside the box, and the lattice steps that are taken out, as domain::PeriodicBox::wrap has them.
static __device__ void wrap_position(const Displacement &box, double x[3], double steps[3])
{
    double given[3] = {x[0], x[1], x[2]}, vector[3], again[3];
    if (!whole_edges(box, given, steps)) return;
    lattice_vector(box, steps, vector);
    for (int axis = 0; axis < 3; axis++) x[axis] = given[axis] - vector[axis];
    // Round-off can leave an image on the far face, or just below the near one.
    if (!whole_edges(box, x, again)) return;
    for (int axis = 0; axis < 3; axis++) steps[axis] += again[axis];
    lattice_vector(box, steps, vector);
    for (int axis = 0; axis < 3; axis++) x[axis] = given[axis] - vector[axis];
    x[0] -= box.strain * x[1];
    for (int axis = 0; axis < 3; axis++) {
        double last = box.edges[axis] * (1 - 2.220446049250313e-16);
        x[axis] = x[axis] < 0 ? 0 : x[axis] > last ? last : x[axis];
    }
    x[0] += box.strain * x[1];
}

// Moves a particle by the sum of its displacements, wraps it into the box, and changes its velocities by that of the
// flow across the lattice vector that is taken out. Tells if it is lost.
static __device__ void displace(const Task &task)
{
    Displacement &box = *task.displacement;
    long long row = thread_index();
    if (row >= box.particles) return;
    double x[3], taken[3], vector[3];
    bool is_somewhere = true;
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int k = 0; k < MOST_COLUMNS && box.terms[k]; k++) sum += box.weights[k] * box.terms[k][3 * row + axis];
        x[axis] = box.positions[3 * row + axis] + sum;
        is_somewhere = is_somewhere && fabs(x[axis] / box.edges[axis]) < box.farthest;
    }
    if (!is_somewhere) {
        box.is_lost = 1;
        return;
    }
    wrap_position(box, x, taken);
    lattice_vector(box, taken, vector);
    for (int axis = 0; axis < 3; axis++) {
        box.moved[3 * row + axis] = x[axis];
        box.counted[3 * row + axis] = box.steps[3 * row + axis] + taken[axis];
        const double *slope = box.gradient + 3 * axis;
        double jump = slope[0] * vector[0] + slope[1] * vector[1] + slope[2] * vector[2];
        for (int k = 0; k < MOST_COLUMNS && box.velocities[k]; k++)
            box.carried[k][3 * row + axis] = box.velocities[k][3 * row + axis] - jump;
    }
}

// Lattice coordinates of particles as fractions of 2^64, from positions in the units of the host; and from the lattice
// steps that were taken out of positions, those that are taken out of the fractions.
static __device__ void place_particles(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const Numbers &box = *task.numbers;
    long long at = 3 * (long long)task.places[row];
    const double *x = (const double *)task.list_x + at, *steps = (const double *)task.list_y + at;
    double along[3] = {x[0] - box.strain * x[1], x[1], x[2]};
    for (int axis = 0; axis < 3; axis++) {
        double fraction = along[axis] / (box.edges[axis] * box.length);
        double whole = floor(fraction), scaled = (fraction - whole) * 18446744073709551616.0 + 0.5;
        bool is_below = scaled < 18446744073709551616.0;
        ((unsigned long long *)task.positions)[3 * row + axis] = is_below ? (unsigned long long)scaled : 0;
        task.periods[3 * row + axis] = (int)(steps[axis] - whole) - (is_below ? 0 : 1);
    }
}
