// Columns of solutions: their extrapolation to the start of the next solve, and those of a new solution. They are in the
// order of the particles' ids, so they stay as they are while rows change their places, and in the units of the host.
#pragma once
#include "coupled.h"

// Columns from which a solve starts: stresslets of the far field, velocities and angular velocities that other spheres
// induce, and those relative to the background; and all columns of a solution: these, forces, torques, stresslets, and
// rates of strain.
namespace column {
static constexpr int FAR_STRESSLET = 0, INDUCED = 1, MOTION = 3, GUESSED = 5;
static constexpr int FORCE = 5, STRESSLET = 7, STRAIN_RATE = 8, ALL = 9;
}

// Number of past solutions.
static constexpr int PAST = 3;

// gpu/src/history.rs has the same fields in the same order.
struct History {
    // Columns of past solutions, the last one first, or 0; and those of a new one.
    const double *past[column::GUESSED][PAST];
    double *found[column::ALL];
    // Weights of the past solutions in a line and in a parabola, and of the parabola in the mix of both by columns.
    double line[PAST], parabola[PAST], blend[column::GUESSED];
    // Units of the host over those of the solve.
    double velocity, rate, torque;
    // Positions, and the velocities and angular velocities of particles that move on the device, or 0; the velocity
    // gradient of the background by rows, and its angular velocity.
    const double *positions;
    double *moving, *turning, gradient[9], spin[3];
    // Motions of the fluid at the particles, which are induced at the start of a solve in place of those of past
    // solutions, or 0: velocities, angular velocities and rates of strain.
    const double *ambient;
};

// A number of a column extrapolated by the line, and by the parabola minus the line.
static __device__ void extrapolate(const History &history, int k, long long at, double &line, double &beyond)
{
    double parabola = 0;
    line = 0;
    for (int age = 0; age < PAST; age++) {
        double value = history.past[k][age][at];
        line += history.line[age] * value;
        parabola += history.parabola[age] * value;
    }
    beyond = parabola - line;
}

// The mix of both; 0 without past solutions.
static __device__ double guessed(const History &history, int k, long long at)
{
    if (!history.past[k][0]) return 0;
    double line, beyond;
    extrapolate(history, k, at, line, beyond);
    return line + history.blend[k] * beyond;
}

// Start of a solve: known loads, those that are given and those of near pairs in the background; motions; loads that
// move single spheres as those of all others do in the guess; minus the stresslets; and motions of the fluid, if there
// are any.
static __device__ void guess_solution(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const History &history = *task.history;
    long long place = task.places[row];
    const double *in_flow = task.in_flow + (SIX + COMPONENTS) * (long long)row;
    const double *ambient = history.ambient ? history.ambient + (SIX + COMPONENTS) * place : nullptr;
    for (int k = 0; k < SIX; k++) {
        long long at = (long long)SIX * row + k, from = 3 * place + k % 3;
        double unit = 1 / (k < 3 ? history.velocity : history.rate);
        double load = in_flow[k] + (task.ambient ? task.ambient[at] : 0);
        double induced = unit * (ambient ? ambient[k] : guessed(history, column::INDUCED + k / 3, from));
        if (ambient) task.residual[at] = induced;
        task.image[at] = load;
        task.unknowns[at] = unit * guessed(history, column::MOTION + k / 3, from);
        task.stiff_loads[at] = load + resistances_of(task, row)[k / 3] * induced;
    }
    for (int k = 0; k < COMPONENTS; k++) {
        double stresslet = guessed(history, column::FAR_STRESSLET, COMPONENTS * place + k);
        long long at = COMPONENTS * (long long)row + k;
        ((double *)task.list_y)[at] = -(stresslet / history.torque);
        if (ambient) task.residual[(long long)SIX * task.particles + at] = ambient[SIX + k] / history.rate;
    }
}

// Columns of a solution, from its result, the known loads, first moments in the background besides those of near pairs
// if there are any, and first moments by motions. Particles that move on the device have velocities and angular
// velocities with those of the background; otherwise those relative to it are stored in the order of the host.
static __device__ void store_solution(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const History &history = *task.history;
    long long place = task.places[row], count = task.particles;
    const double *motion = task.direction + SIX * (long long)row, *load = motion + SIX * count;
    const double *moment = task.direction + 2 * SIX * count + COMPONENTS * (long long)row;
    const double *strain = moment + COMPONENTS * count;
    const double *in_flow = task.in_flow + (SIX + COMPONENTS) * (long long)row + SIX;
    const double *by_motions = (const double *)task.list_x + COMPONENTS * (long long)row;
    const double *given = (const double *)task.list_weights;
    for (int k = 0; k < SIX; k++) {
        long long to = 3 * place + k % 3;
        int of_kind = k / 3;
        double unit = of_kind == 0 ? history.velocity : history.rate;
        double on_fluid = task.ambient[SIX * (long long)row + k] + load[k];
        double induced = motion[k] - on_fluid / resistances_of(task, row)[of_kind];
        history.found[column::INDUCED + of_kind][to] = induced * unit;
        history.found[column::MOTION + of_kind][to] = motion[k] * unit;
        history.found[column::FORCE + of_kind][to] = of_kind == 0 ? on_fluid : on_fluid * history.torque;
        if (!history.moving) task.image[3 * count * of_kind + 3 * row + k % 3] = motion[k] * unit;
    }
    for (int axis = 0; history.moving && axis < 3; axis++) {
        const double *x = history.positions + 3 * place, *slope = history.gradient + 3 * axis;
        double flow = slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2];
        history.moving[3 * place + axis] = motion[axis] * history.velocity + flow;
        history.turning[3 * place + axis] = motion[3 + axis] * history.rate + history.spin[axis];
    }
    for (int k = 0; k < COMPONENTS; k++) {
        long long to = COMPONENTS * place + k;
        double known = in_flow[k] + (given ? given[COMPONENTS * (long long)row + k] : 0);
        history.found[column::FAR_STRESSLET][to] = -moment[k] * history.torque;
        history.found[column::STRESSLET][to] = (-moment[k] + (known - by_motions[k])) * history.torque;
        history.found[column::STRAIN_RATE][to] = strain[k] * history.rate;
    }
}

// Sums for the weights of the parabola with which the guess would have come closest to the columns of a solution: the
// products of what is beyond the line, in the solution and by the parabola, and the squares of the latter, by columns,
// or 0 without past solutions. The last sum is that of the squares of velocities.
static __device__ void compare_with_guess(const Task &task)
{
    long long row = thread_index();
    const History &history = *task.history;
    for (int k = 0; k < column::GUESSED; k++) {
        int width = k == column::FAR_STRESSLET ? COMPONENTS : 3;
        double along = 0, square = 0;
        for (int i = 0; history.past[k][0] && row < task.particles && i < width; i++) {
            double line, beyond;
            extrapolate(history, k, width * row + i, line, beyond);
            along += (history.found[k][width * row + i] - line) * beyond;
            square += beyond * beyond;
        }
        store_sum(along, task.list_sums + 2 * k * task.list_size + blockIdx.x);
        store_sum(square, task.list_sums + (2 * k + 1) * task.list_size + blockIdx.x);
    }
    double square = 0;
    for (int i = 0; row < task.particles && i < 3; i++) {
        double velocity = history.found[column::MOTION][3 * row + i];
        square += velocity * velocity;
    }
    store_sum(square, task.list_sums + 2 * column::GUESSED * task.list_size + blockIdx.x);
}
