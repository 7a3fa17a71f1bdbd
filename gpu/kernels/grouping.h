// Groups of spheres that the preconditioner couples, and their places in its blocks of threads. At first each sphere is
// a group. In a round each group chooses the strongest stiff pair that joins it to another one, of all pairs that make
// groups of at most GROUP spheres, and groups that choose each other join. After enough rounds the groups are those of
// the pairs taken one by one, the strongest first. Threads write what no other thread reads or writes, so the groups do
// not depend on their order.
#pragma once
#include "groups.h"

// Pairs join groups if the force on a sphere by the other one's velocity along the axis is at least half of the mean
// resistance of the two as single spheres; powers of two of the square of this ratio, of which larger ones are one.
static constexpr int WEAKEST = -2, STRONGEST = 30;

// Groups of one sphere each, and blocks without members.
static __device__ void start_groups(const Task &task)
{
    int at = thread_index();
    if (at < task.list_size) task.members[at] = {-1, 0, 0};
    if (at < task.particles) task.groups[at] = {at, 1, -1, {at}};
}

// A number in random order.
static __device__ unsigned mixed(unsigned number)
{
    number = (number ^ number >> 16) * 0x85ebca6bu;
    number = (number ^ number >> 13) * 0xc2b2ae35u;
    return number ^ number >> 16;
}

// Rank of a stiff pair, which is the same in the rows of both spheres: higher powers of two come first, and within one
// the order is random, so that few pairs wait for others. Weak pairs have the rank 0.
static __device__ unsigned long long rank_of(const Task &task, int row, int entry)
{
    long long entries = task.numbers->near_entries[STIFF];
    const double *numbers = (const double *)task.near_numbers[STIFF] + entry;
    // Translation across the axis, and along it minus across.
    double force = numbers[3 * entries] + numbers[4 * entries];
    int other = task.near_others[STIFF][entry];
    int power = ilogb(force * force / (resistances_of(task, row)[0] * resistances_of(task, other)[0]));
    if (power < WEAKEST) return 0;
    unsigned pair = mixed((unsigned)(row < other ? row : other) ^ mixed((unsigned)(row < other ? other : row)));
    return (unsigned long long)((power < STRONGEST ? power : STRONGEST) - WEAKEST + 1) << 32 | pair;
}

// The choice of each group.
static __device__ void choose_group(const Task &task)
{
    int root = thread_index();
    if (root >= task.particles) return;
    SphereGroup &own = task.groups[root];
    unsigned long long best = 0;
    own.choice = -1;
    for (int member = 0; member < own.count; member++) {
        int row = own.rows[member];
        for (int entry = task.near_starts[STIFF][row]; entry < task.near_starts[STIFF][row + 1]; entry++) {
            int other = task.groups[task.near_others[STIFF][entry]].root;
            if (other == root || own.count + task.groups[other].count > GROUP) continue;
            unsigned long long rank = rank_of(task, row, entry);
            if (rank > best) best = rank, own.choice = other;
        }
    }
}

// Joins groups that have chosen each other.
static __device__ void join_group(const Task &task)
{
    int root = thread_index();
    if (root >= task.particles) return;
    SphereGroup &own = task.groups[root];
    if (own.choice < root || task.groups[own.choice].choice != root) return;
    SphereGroup &other = task.groups[own.choice];
    for (int member = 0; member < other.count; member++) {
        int row = other.rows[member];
        own.rows[own.count + member] = row;
        task.groups[row].root = root;
    }
    own.count += other.count;
    other.count = 0;
}

// Groups of each number of spheres, one list after the other, as counts that are summed up next.
static __device__ void count_group(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    for (int count = 1; count <= GROUP; count++)
        task.group_places[(long long)(count - 1) * task.particles + row] = task.groups[row].count == count;
    if (row == 0) task.group_places[(long long)GROUP * task.particles] = 0;
}

// Members of blocks. A block has groups of the same number of spheres, as many as there is room for.
static __device__ void place_group(const Task &task)
{
    int root = thread_index();
    if (root >= task.particles || task.groups[root].count == 0) return;
    const SphereGroup &own = task.groups[root];
    auto before = [&](int count) { return task.group_places[(long long)(count - 1) * task.particles]; };
    int block = 0, of_block = BLOCK_MEMBERS / own.count;
    for (int count = 1; count < own.count; count++)
        block += (before(count + 1) - before(count) + BLOCK_MEMBERS / count - 1) / (BLOCK_MEMBERS / count);
    int number = task.group_places[(long long)(own.count - 1) * task.particles + root] - before(own.count);
    block += number / of_block;
    int first = number % of_block * own.count;
    GroupMember *members = task.members + (long long)BLOCK_MEMBERS * block + first;
    for (int member = 0; member < own.count; member++)
        members[member] = {own.rows[member], (short)first, (short)own.count};
}
