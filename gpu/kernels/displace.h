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
    // Edges, strain and tilts of the box, its axes as those of Numbers, and the velocity gradient of the flow by rows.
    double edges[3], strain, tilts[2], axes[9], gradient[9];
    // Deformation of displaced positions and of velocities by the flow, by rows.
    double deformation[9];
    // Distance from the box, in edges, from which on a particle is lost.
    double farthest;
    // Matrix by rows that turns lattice steps so far into those along the vectors of the box.
    long long renaming[9];
    long long particles, is_rotated, is_lost;
};

// Product of a matrix by rows and a vector.
static __device__ void transform_vector(const double matrix[9], const double x[3], double product[3])
{
    for (int a = 0; a < 3; a++) {
        const double *row = matrix + 3 * a;
        product[a] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2];
    }
}

// Lattice coordinates of a position in a box with a strain and two tilts, whose axes are given if they are not those of
// space, as domain::PeriodicBox::lattice_coordinates has them.
static __device__ void lattice_coordinates(
    double strain, const double tilts[2], const double *axes, const double x[3], double along[3])
{
    for (int a = 0; a < 3; a++) along[a] = axes ? axes[a] * x[0] + axes[3 + a] * x[1] + axes[6 + a] * x[2] : x[a];
    along[1] -= tilts[1] * along[2];
    along[0] = along[0] - strain * along[1] - tilts[0] * along[2];
}

// Position with some lattice coordinates.
static __device__ void position_of(const Displacement &box, const double along[3], double x[3])
{
    double tilted[3] = {along[0] + box.strain * along[1] + box.tilts[0] * along[2], along[1] + box.tilts[1] * along[2],
        along[2]};
    if (box.is_rotated) return transform_vector(box.axes, tilted, x);
    for (int axis = 0; axis < 3; axis++) x[axis] = tilted[axis];
}

// Lattice vector of some steps.
static __device__ void lattice_vector(const Displacement &box, const double steps[3], double x[3])
{
    double along[3];
    for (int axis = 0; axis < 3; axis++) along[axis] = steps[axis] * box.edges[axis];
    position_of(box, along, x);
}

// Lattice coordinates of a position, and the whole edges in them. Returns whether there are any.
static __device__ bool whole_edges(const Displacement &box, const double x[3], double along[3], double steps[3])
{
    lattice_coordinates(box.strain, box.tilts, box.is_rotated ? box.axes : 0, x, along);
    for (int axis = 0; axis < 3; axis++) steps[axis] = floor(along[axis] / box.edges[axis]);
    return steps[0] != 0 || steps[1] != 0 || steps[2] != 0;
}

// Image of a position inside the box, and the lattice steps that are taken out, as domain::PeriodicBox::wrap has them.
static __device__ void wrap_position(const Displacement &box, double x[3], double steps[3])
{
    double given[3] = {x[0], x[1], x[2]}, along[3], vector[3], again[3];
    if (!whole_edges(box, given, along, steps)) return;
    lattice_vector(box, steps, vector);
    for (int axis = 0; axis < 3; axis++) x[axis] = given[axis] - vector[axis];
    // Round-off can leave an image on the far face, or just below the near one.
    if (!whole_edges(box, x, along, again)) return;
    for (int axis = 0; axis < 3; axis++) steps[axis] += again[axis];
    lattice_vector(box, steps, vector);
    for (int axis = 0; axis < 3; axis++) x[axis] = given[axis] - vector[axis];
    whole_edges(box, x, along, again);
    for (int axis = 0; axis < 3; axis++) {
        double last = box.edges[axis] * (1 - 2.220446049250313e-16);
        along[axis] = along[axis] < 0 ? 0 : along[axis] > last ? last : along[axis];
    }
    position_of(box, along, x);
}

// Lattice steps so far along the vectors of the box, modulo 2^32 as domain::Particles::relabel has them.
static __device__ void rename_steps(const Displacement &box, const double steps[3], double renamed[3])
{
    for (int axis = 0; axis < 3; axis++) {
        unsigned int sum = 0;
        for (int k = 0; k < 3; k++)
            sum += (unsigned int)box.renaming[3 * axis + k] * (unsigned int)(long long)steps[k];
        renamed[axis] = (int)sum;
    }
}

// Moves a particle by the sum of its displacements and with the flow, which deforms its velocities too, wraps it into the
// box, and changes its velocities by that of the flow across the lattice vector that is taken out. Tells if it is lost.
static __device__ void displace(const Task &task)
{
    Displacement &box = *task.displacement;
    long long row = thread_index();
    if (row >= box.particles) return;
    double displaced[3], x[3], renamed[3], taken[3], vector[3];
    bool is_somewhere = true;
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int k = 0; k < MOST_COLUMNS && box.terms[k]; k++) sum += box.weights[k] * box.terms[k][3 * row + axis];
        displaced[axis] = box.positions[3 * row + axis] + sum;
        is_somewhere = is_somewhere && fabs(displaced[axis] / box.edges[axis]) < box.farthest;
    }
    if (!is_somewhere) {
        box.is_lost = 1;
        return;
    }
    transform_vector(box.deformation, displaced, x);
    rename_steps(box, box.steps + 3 * row, renamed);
    wrap_position(box, x, taken);
    lattice_vector(box, taken, vector);
    for (int axis = 0; axis < 3; axis++) {
        box.moved[3 * row + axis] = x[axis];
        box.counted[3 * row + axis] = renamed[axis] + taken[axis];
    }
    double jump[3], deformed[3];
    transform_vector(box.gradient, vector, jump);
    for (int k = 0; k < MOST_COLUMNS && box.velocities[k]; k++) {
        transform_vector(box.deformation, box.velocities[k] + 3 * row, deformed);
        for (int axis = 0; axis < 3; axis++) box.carried[k][3 * row + axis] = deformed[axis] - jump[axis];
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
    double tilts[2] = {box.tilt_x, box.tilt_y}, along[3];
    lattice_coordinates(box.strain, tilts, task.is_rotated ? box.axes : 0, x, along);
    for (int axis = 0; axis < 3; axis++) {
        double fraction = along[axis] / (box.edges[axis] * box.length);
        double whole = floor(fraction), scaled = (fraction - whole) * 18446744073709551616.0 + 0.5;
        bool is_below = scaled < 18446744073709551616.0;
        ((unsigned long long *)task.positions)[3 * row + axis] = is_below ? (unsigned long long)scaled : 0;
        task.periods[3 * row + axis] = (int)(long long)(steps[axis] - whole) - (is_below ? 0 : 1);
    }
}
