// Random forces and torques of lubrication, as in hydrodynamics/src/noise.rs: of each near pair the factor B of its
// resistance B B^T (lubrication/src/pair_factor.rs) times normal numbers.
#pragma once
#include "assembly.h"
#include "noise.h"

// Modes of a pair: two along its axis, two about it, and four in each of two planes.
static constexpr int PAIR_MODES = 12;

// Whether a pair is oriented from the sphere of a row to the other one: from the lower id to the higher one, and between
// two images of one sphere by the steps between them.
static __device__ bool is_first(const Task &task, int row, int other, const int image[3])
{
    if (task.ids[row] != task.ids[other]) return task.ids[row] < task.ids[other];
    for (int axis = 0; axis < 3; axis++)
        if (image[axis] != 0) return image[axis] < 0;
    return false;
}

// Normal numbers of a pair by the ids of its spheres and the steps from one to the other.
static __device__ void pair_numbers(const Task &task, int first, int second, const int image[3], double modes[PAIR_MODES])
{
    Random name(task.ids[first], task.ids[second]);
    unsigned long long steps = 0;
    for (int axis = 0; axis < 3; axis++) steps = steps << 21 ^ (unsigned long long)(image[axis] + (1 << 20));
    Random random(task.numbers->noise_seed, name.next_bits() ^ steps);
    for (int k = 0; k < PAIR_MODES; k += 2) random.next_normal(modes + k);
}

// The first two axes of a frame whose third axis is given; they are those of the host.
static __device__ void set_frame(const double z[3], double x[3], double y[3])
{
    bool is_mirrored = z[2] < -0.999;
    double sign = is_mirrored ? -1 : 1, a = sign * z[0], b = sign * z[1], c = sign * z[2], scale = 1 / (1 + c);
    const double first[3] = {1 - a * a * scale, -a * b * scale, -a}, second[3] = {-a * b * scale, 1 - b * b * scale, -b};
    for (int k = 0; k < 3; k++) x[k] = is_mirrored ? second[k] : first[k], y[k] = is_mirrored ? first[k] : second[k];
}

// Loads of the modes on one sphere of a pair, the smaller one (0) or the larger one (1), by the table of the smaller
// one and the axis from there to the larger one.
static __device__ void add_modes(
    const StiffTable &table, const double z[3], int side, const double modes[PAIR_MODES], double load[SIX])
{
    const GapSeries<FACTORS> &f = table.functions;
    const double single[4] = {table.moving[0], table.moving[1], table.turning[0], table.turning[1]};
    double factor = sqrt(table.factor), x[3], y[3], across[2], turning[2];
    double opening = single[0] * f.value(0) * modes[0];
    double mean = single[0] * table.root_of_sum * (f.value(1) * modes[0] + f.value(2) * modes[1]);
    double along = table.share[side] * mean + (side == 0 ? -opening : opening);
    double spin = single[2 + side] * (f.value(10 + side) * modes[2] + f.value(11 + side) * modes[3]);
    for (int plane = 0; plane < 2; plane++) {
        across[plane] = turning[plane] = 0;
        for (int mode = 0; mode < 4; mode++) {
            double number = modes[4 + 4 * plane + mode];
            across[plane] += single[side] * f.value(13 + triangle(side, mode)) * number;
            turning[plane] += single[2 + side] * f.value(13 + triangle(2 + side, mode)) * number;
        }
    }
    set_frame(z, x, y);
    for (int k = 0; k < 3; k++) {
        load[k] += factor * (across[0] * x[k] + across[1] * y[k] + along * z[k]);
        load[3 + k] += factor * table.radius * (-turning[1] * x[k] + turning[0] * y[k] + spin * z[k]);
    }
}

// Random loads of all near pairs on each sphere times a factor, six numbers each, added to given loads if there
// are any. Each of two spheres computes the numbers of its pair.
template <typename T> __device__ void random_loads(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    int row = task.rows[target];
    double load[SIX] = {0, 0, 0, 0, 0, 0};
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source], image[3];
        NearPair pair = near_pair(task, row, other, packed_steps(steps));
        double gap = pair.distance - pair.kind->sum, modes[PAIR_MODES];
        if (pair.distance == 0 || gap >= pair.kind->cutoff) return;
        for (int axis = 0; axis < 3; axis++)
            image[axis] = steps[axis] + task.periods[3 * other + axis] - task.periods[3 * row + axis];
        // Of two spheres of the same size the first one takes the place of the smaller one.
        bool is_own_first = is_first(task, row, other, image), is_equal = pair.kind->ratio == 1;
        bool is_larger = is_equal ? !is_own_first : pair.kind->is_larger != 0;
        for (int axis = 0; axis < 3; axis++) {
            if (!is_own_first) image[axis] = -image[axis];
            if (!is_own_first && is_equal) pair.axis[axis] = -pair.axis[axis];
        }
        pair_numbers(task, is_own_first ? row : other, is_own_first ? other : row, image, modes);
        int small = is_larger ? other : row, large = is_larger ? row : other;
        const NearKind &kind = task.near_kinds[task.classes[small] * task.class_count + task.classes[large]];
        add_modes(stiff_table(task, kind, gap), pair.axis, is_larger ? 1 : 0, modes, load);
    };
    visit_around<T>(task, target, task.near_reach, visit);
    for (int k = 0; k < SIX; k++) {
        double given = task.ambient ? task.ambient[SIX * row + k] : 0;
        task.image[SIX * row + k] = given + task.factor * load[k];
    }
}
