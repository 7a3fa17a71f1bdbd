// Near pairs within the range of lubrication or springs, and the rows of their resistance, for the spheres where they
// are.
#pragma once
#include "near.h"
#include "neighbours.h"
#include "pair_sides.h"
#include "springs.h"

static constexpr int ASSEMBLY_THREADS = 128;
// Loads and first moment of a sphere at rest in the rate of strain of the background.
static constexpr int IN_FLOW = SIX + COMPONENTS;

// A pair of a row: distance, height of the middle of the centres, and the axis from the smaller sphere to the larger, or
// to the other one of the same size.
struct NearPair {
    double distance, height, axis[3];
    const NearKind *kind;
};

static __device__ NearPair near_pair(const Task &task, int row, int other, int packed)
{
    NearPair pair;
    pair.kind = task.near_kinds + task.classes[row] * task.class_count + task.classes[other];
    double x[3], z[3];
    int steps[3];
    for (int axis = 0; axis < 3; axis++) steps[axis] = steps_along(packed, axis);
    const unsigned long long *positions = task.positions;
    separation_of<double>(task, positions + 3 * row, positions + 3 * other, steps, x);
    pair.distance = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    double of_row = (double)positions[3 * row + 2] * Precision<double>::UNIT * task.numbers->edges[2];
    pair.height = task.numbers->lowest + of_row - 0.5 * x[2];
    double scale = (pair.kind->is_larger != 0 ? 1 : -1) / pair.distance;
    for (int axis = 0; axis < 3; axis++) z[axis] = x[axis] * scale;
    turn_to_space(task, z, pair.axis);
    return pair;
}

// Coefficients of the lubrication of a pair; those of a pair out of its range are zero.
template <int SET> __device__ SphereRow side_of(const Task &task, const NearPair &pair)
{
    double gap = pair.distance - pair.kind->sum;
    if (gap >= pair.kind->cutoff) return SphereRow{};
    return SET == STIFF ? stiff_side(task, *pair.kind, gap) : soft_side(task, *pair.kind, gap);
}

// Number of the pairs of a row that the host gives, after those that are found.
static __device__ int given_pairs(const Task &task, int row)
{
    return task.given_starts ? task.given_starts[row + 1] - task.given_starts[row] : 0;
}

// Whether the host gives a pair of a row and another particle, which makes their lubrication stiff at any gap.
static __device__ bool is_given(const Task &task, int row, int other)
{
    int end = task.given_starts ? task.given_starts[row + 1] : 0;
    for (int pair = task.given_starts ? task.given_starts[row] : 0; pair < end; pair++)
        if (task.given_others[pair] == other) return true;
    return false;
}

// Finds the near pairs of each particle: first, without lists, the numbers of stiff and of soft pairs; then the lists.
// Both are one kernel, so that a pair is in the same set whatever the compiler makes of the arithmetic.
template <typename T> __device__ void find_near(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    int row = task.rows[target], at[2] = {0, 0};
    bool is_listed = task.near_others[STIFF] != nullptr, has_springs = task.contacts || task.predicted;
    for (int set = 0; is_listed && set < 2; set++) at[set] = task.near_starts[set][row];
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source], packed = packed_steps(steps);
        NearPair pair = near_pair(task, row, other, packed);
        double gap = pair.distance - pair.kind->sum;
        bool is_sprung = has_springs && springs_between(task, row, other, packed, pair.distance).along > 0;
        if (pair.distance == 0 || (gap >= pair.kind->cutoff && !is_sprung)) return;
        int set = is_sprung || gap < pair.kind->stiff_gap || is_given(task, row, other) ? STIFF : SOFT;
        if (is_listed) {
            task.near_others[set][at[set]] = other;
            task.near_steps[set][at[set]] = packed;
        }
        at[set]++;
    };
    if (task.near_series || has_springs) visit_around<T>(task, target, task.near_reach, visit);
    if (is_listed) return;
    task.near_starts[STIFF][row] = at[STIFF] + given_pairs(task, row);
    task.near_starts[SOFT][row] = at[SOFT];
}

// Stores the numbers of a pair in the list of its set.
template <typename S, int SET>
__device__ void store_pair(const Task &task, int entry, const double z[3], const SphereRow &row)
{
    const double numbers[PAIR_NUMBERS] = {
        z[0], z[1], z[2], row.ya[1], row.xa[1] - row.ya[1], row.yc[1], row.xc[1] - row.yc[1], row.yb[1], row.yb_other};
    S *list = (S *)task.near_numbers[SET] + entry;
    for (int k = 0; k < PAIR_NUMBERS; k++) list[k * task.numbers->near_entries[SET]] = (S)numbers[k];
}

// Adds the resistance of a sphere to its own motion by a pair.
static __device__ void add_to_own(const SphereRow &row, const double z[3], double own[OWN_NUMBERS])
{
    double along = row.xa[0] - row.ya[0], spin = row.xc[0] - row.yc[0];
    for (int i = 0, k = 0; i < 3; i++) {
        own[12 + i] += row.yb[0] * z[i];
        for (int j = i; j < 3; j++, k++) {
            own[k] += along * z[i] * z[j] + (i == j ? row.ya[0] : 0);
            own[6 + k] += spin * z[i] * z[j] + (i == j ? row.yc[0] : 0);
        }
    }
}

// Adds `stretch (3 zz - 1) + z s + s z` to the components of a symmetric matrix without a trace.
static __device__ void add_tensor(double stretch, const double s[3], const double z[3], double moment[COMPONENTS])
{
    for (int i = 0, k = 0; k < COMPONENTS; i++)
        for (int j = i; j < 3 && k < COMPONENTS; j++, k++)
            moment[k] += 3 * stretch * z[i] * z[j] + z[i] * s[j] + s[i] * z[j] - (i == j ? stretch : 0);
}

// Adds the loads and the first moment of a sphere at rest in the background by a pair.
static __device__ void add_in_flow(const Task &task, const SphereRow &row, const NearPair &pair, double sums[IN_FLOW])
{
    const double *uniform = task.numbers->background, *slope = task.numbers->slope, *z = pair.axis;
    const double e[COMPONENTS] = {
        uniform[0], uniform[1], uniform[2] + slope[0] * pair.height, uniform[3], uniform[4] + slope[1] * pair.height};
    const double rows[3][3] = {{e[0], e[1], e[2]}, {e[1], e[3], e[4]}, {e[2], e[4], -e[0] - e[3]}};
    double cross[3], shear[3];
    for (int i = 0; i < 3; i++) cross[i] = dot(rows[i], z);
    double along = dot(cross, z);
    for (int i = 0; i < 3; i++) cross[i] -= along * z[i], shear[i] = row.ym_minus_zm * cross[i];
    for (int i = 0; i < 3; i++) {
        sums[i] += row.xg_strain * along * z[i] + row.yg_strain * cross[i];
        sums[3 + i] += row.yh_strain * across(z, cross, i);
    }
    add_tensor(row.xm_minus_zm_half * along, shear, z, sums + SIX);
    for (int k = 0; k < COMPONENTS; k++) sums[SIX + k] += row.zm * e[k];
}

// Copies the numbers of a stiff pair that the host gives.
static __device__ void copy_given(const Task &task, int given, int entry)
{
    double *list = (double *)task.near_numbers[STIFF] + entry;
    task.near_others[STIFF][entry] = task.given_others[given];
    for (int k = 0; k < PAIR_NUMBERS; k++)
        list[k * task.numbers->near_entries[STIFF]] = task.given_numbers[k * task.numbers->given_entries + given];
}

// Rows of a set of pairs with eight threads each: numbers of the pairs, and by row the resistance of the sphere to its
// own motion, and the loads and first moments in the background, to which those of soft pairs are added.
template <typename S, int SET> __device__ void assemble(const Task &task)
{
    constexpr int SUMS = OWN_NUMBERS + IN_FLOW;
    SHARED(double, partial, SUMS *ASSEMBLY_THREADS);
    int thread = (int)threadIdx.x, lane = thread % ROW_LANES, first = thread - lane;
    int row = (int)(blockIdx.x * (ASSEMBLY_THREADS / ROW_LANES)) + thread / ROW_LANES;
    bool is_there = row < task.particles;
    double sums[SUMS];
    for (int k = 0; k < SUMS; k++) sums[k] = 0;
    int given = is_there && SET == STIFF ? given_pairs(task, row) : 0;
    int end = is_there ? task.near_starts[SET][row + 1] - given : 0;
    for (int entry = is_there ? task.near_starts[SET][row] + lane : 0; entry < end; entry += ROW_LANES) {
        int other = task.near_others[SET][entry], packed = task.near_steps[SET][entry];
        NearPair pair = near_pair(task, row, other, packed);
        SphereRow side = side_of<SET>(task, pair);
        if (SET == STIFF && (task.contacts || task.predicted))
            add_springs(*pair.kind, springs_between(task, row, other, packed, pair.distance), pair.distance, side);
        store_pair<S, SET>(task, entry, pair.axis, side);
        add_to_own(side, pair.axis, sums);
        add_in_flow(task, side, pair, sums + OWN_NUMBERS);
    }
    for (int k = lane; k < given; k += ROW_LANES) copy_given(task, task.given_starts[row] + k, end + k);
    for (int k = 0; k < SUMS; k++) partial[k * ASSEMBLY_THREADS + thread] = sums[k];
    __syncthreads();
    for (int k = lane; is_there && k < SUMS; k += ROW_LANES) {
        double sum = 0;
        for (int other = 0; other < ROW_LANES; other++) sum += partial[k * ASSEMBLY_THREADS + first + other];
        if (k >= OWN_NUMBERS) {
            double *to = task.in_flow + IN_FLOW * row + k - OWN_NUMBERS;
            *to = SET == STIFF ? sum : *to + sum;
        } else {
            if (SET == STIFF && task.given_own) sum += task.given_own[OWN_NUMBERS * row + k];
            task.near_own[SET][OWN_NUMBERS * row + k] = sum;
        }
    }
}

// Component of the first moment of a sphere at walls across z by its own motion u, see gpu/src/pair_rows.rs.
static __device__ double moment_at_walls(const double at_walls[WALL_NUMBERS], const double u[SIX], int component)
{
    const double *turn = u + 3;
    switch (component) {
    case 2: return at_walls[1] * u[0] + at_walls[2] * turn[1];
    case 4: return at_walls[1] * u[1] - at_walls[2] * turn[0];
    case 1: return 0;
    default: return -at_walls[0] * u[2];
    }
}

// First moments by the motions of spheres in a direction, with eight threads a row; those of stiff pairs are with those
// at walls, and those of soft pairs are added.
template <int SET> __device__ void near_moments(const Task &task)
{
    SHARED(double, partial, COMPONENTS *ASSEMBLY_THREADS);
    int thread = (int)threadIdx.x, lane = thread % ROW_LANES, first = thread - lane;
    int row = (int)(blockIdx.x * (ASSEMBLY_THREADS / ROW_LANES)) + thread / ROW_LANES;
    bool is_there = row < task.particles;
    double sums[COMPONENTS] = {0, 0, 0, 0, 0};
    int end = is_there ? task.near_starts[SET][row + 1] - (SET == STIFF ? given_pairs(task, row) : 0) : 0;
    for (int entry = is_there ? task.near_starts[SET][row] + lane : 0; entry < end; entry += ROW_LANES) {
        int other = task.near_others[SET][entry];
        NearPair pair = near_pair(task, row, other, task.near_steps[SET][entry]);
        SphereRow side = side_of<SET>(task, pair);
        const double *z = pair.axis;
        double stretch = 0, shear[3] = {0, 0, 0};
        for (int sphere = 0; sphere < 2; sphere++) {
            const double *u = task.direction + SIX * (sphere == 0 ? row : other), *turn = u + 3;
            double along = dot(z, u);
            stretch += side.xg[sphere] * along;
            for (int i = 0; i < 3; i++)
                shear[i] += side.yg[sphere] * (u[i] - along * z[i]) + side.yh[sphere] * across(turn, z, i);
        }
        add_tensor(stretch, shear, z, sums);
    }
    for (int k = 0; k < COMPONENTS; k++) partial[k * ASSEMBLY_THREADS + thread] = sums[k];
    __syncthreads();
    if (!is_there || lane >= COMPONENTS) return;
    double sum = 0, *to = task.image + COMPONENTS * row + lane;
    for (int other = 0; other < ROW_LANES; other++) sum += partial[lane * ASSEMBLY_THREADS + first + other];
    if (SET == STIFF && task.given_at_walls)
        sum += moment_at_walls(task.given_at_walls + WALL_NUMBERS * row, task.direction + SIX * row, lane);
    *to = SET == STIFF ? sum : *to + sum;
}
