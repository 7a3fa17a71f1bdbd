// Contacts of rough spheres that move on the device, as suspension/src/forces/contacts has them. Both spheres of a
// contact see the same bits: it is computed as seen by the first one in the order of ids, with the state that this one
// has noted.
#pragma once
#include "near.h"
#include "predicted.h"

// Numbers of a contact in the columns of its state: the id of the other sphere plus one, or 0 for an empty slot; the
// tangential and the rolling force, the normal force, and the shares of the two springs.
static constexpr int CONTACT = 10;
// Resistances of a contact: along the line of centres, to slip, and to rolling.
static constexpr int CONTACT_RESISTANCES = 3;
// Fraction of the derivative of a limited friction force that is treated implicitly.
static constexpr double CUT = 0.5;

// Sums over all spheres, which are 0 at first: the number of particles less the place of the first sphere with more
// contacts than slots; and the bits of the largest load, which are ordered as positive numbers are.
struct ContactSums {
    unsigned long long crowded, largest;
};

// All numbers are in the units of the solve, but for columns. gpu/src/contacts.rs has the same fields in the same order.
struct Contacts {
    // Columns in the order of ids and in the units of the host, or 0: positions; expected velocities with a part of the
    // background; state at the start of the substep; velocities and angular velocities, relative to the background, of
    // the previous solution and of the one that ends the substep; state at its end.
    const double *positions, *expected, *history, *previous[2], *motions[2];
    double *found;
    // Steady loads or 0, and these with the known parts of contact loads, six numbers a row.
    const double *steady;
    double *loads;
    // Radii by class.
    const double *radii;
    // Number of contacts of each row; and by slots of rows in the order of the others' ids, other rows, packed steps to
    // the periodic image, and resistances.
    int *counts, *others, *steps;
    double *resistances;
    ContactSums *sums;
    // The law, see lubrication/src/contact.rs.
    double friction, roughness, stiffness, tangential_ratio, rolling_friction, critical_load;
    // Times over which forces are predicted along the line of centres and across; the distance of centres up to which
    // any two spheres touch; factors of velocities and of rates from the units of the host.
    double along, across, reach, velocity, rate;
    // Velocity gradients of the background, and of the part of it that expected velocities contain, by rows in the units
    // of the host.
    double gradient[9], carried[9];
    long long slots, is_hertz;
};

// A contact as its first sphere sees it.
struct Touching {
    // Rows, and the radii; distances of the centres from the point of contact.
    int first, second;
    double radii[2], arms[2];
    // Vector from the first centre to the second, and its direction.
    double separation[3], axis[3], overlap, harmonic;
};

// State of a contact.
struct ContactState {
    double force[3], rolling[3], normal, shares[2];
};

// Relative motion at a contact: the rate at which the centres separate; slip and rolling velocity.
struct ContactMotion {
    double separating, slip[3], rolling[3];
};

// Removes the component along a unit vector.
static __device__ void flatten(const double axis[3], double v[3])
{
    double along = dot(axis, v);
    for (int k = 0; k < 3; k++) v[k] -= along * axis[k];
}

// Whether a row sees a contact with another as the second one of both.
static __device__ bool is_second(const Task &task, int row, int other)
{
    return task.places[row] > task.places[other];
}

static __device__ Touching contact_between(const Task &task, const Contacts &contacts, int row, int other, int packed)
{
    Touching contact;
    bool swaps = is_second(task, row, other);
    int steps[3];
    for (int axis = 0; axis < 3; axis++) steps[axis] = (swaps ? -1 : 1) * steps_along(packed, axis);
    contact.first = swaps ? other : row, contact.second = swaps ? row : other;
    const unsigned long long *positions = task.positions;
    double x[3];
    separation_of<double>(task, positions + 3 * contact.first, positions + 3 * contact.second, steps, x);
    turn_to_space(task, x, contact.separation);
    double distance = sqrt(dot(x, x));
    contact.radii[0] = contacts.radii[task.classes[contact.first]];
    contact.radii[1] = contacts.radii[task.classes[contact.second]];
    double sum = contact.radii[0] + contact.radii[1];
    for (int k = 0; k < 2; k++) contact.arms[k] = distance * contact.radii[k] / sum;
    for (int k = 0; k < 3; k++) {
        contact.separation[k] = -contact.separation[k];
        contact.axis[k] = contact.separation[k] / distance;
    }
    contact.overlap = sum * (1 + 0.5 * contacts.roughness) - distance;
    contact.harmonic = 2 * contact.radii[0] * contact.radii[1] / sum;
    return contact;
}

// Appends a contact to those of a row, in the order of the others' ids. Returns whether there is a slot for it.
static __device__ bool insert_contact(
    const Task &task, const Contacts &contacts, int row, int other, int packed, int count)
{
    if (count == contacts.slots) return false;
    long long first = contacts.slots * row, at = first + count;
    int place = task.places[other];
    for (; at > first; at--) {
        int before = contacts.others[at - 1], steps = contacts.steps[at - 1];
        if (task.places[before] < place || (before == other && steps < packed)) break;
        contacts.others[at] = before, contacts.steps[at] = steps;
    }
    contacts.others[at] = other, contacts.steps[at] = packed;
    return true;
}

// Finds the contacts of each particle.
template <typename T> __device__ void find_contacts(const Task &task)
{
    int target = thread_index();
    if (target >= task.particles) return;
    const Contacts &contacts = *task.contacts;
    int row = task.rows[target], count = 0;
    bool is_crowded = false;
    auto visit = [&](int source, const int steps[3]) {
        int other = task.rows[source], packed = packed_steps(steps);
        if (contact_between(task, contacts, row, other, packed).overlap <= 0) return;
        if (insert_contact(task, contacts, row, other, packed, count)) count++;
        else is_crowded = true;
    };
    visit_around<T>(task, target, task.near_reach, visit);
    contacts.counts[row] = count;
    if (is_crowded) atomicMax(&contacts.sums->crowded, (unsigned long long)(task.particles - task.places[row]));
}

// State at the start of the substep, with forces turned into the present tangential plane.
static __device__ void turn_force(const double axis[3], double force[3])
{
    double before = sqrt(dot(force, force));
    flatten(axis, force);
    double flat = sqrt(dot(force, force));
    for (int k = 0; flat != 0 && k < 3; k++) force[k] *= before / flat;
}

static __device__ ContactState state_at_start(const Task &task, const Contacts &contacts, const Touching &contact)
{
    ContactState state = {{0, 0, 0}, {0, 0, 0}, 0, {1, 1}};
    if (!contacts.history) return state;
    const double *slot = contacts.history + CONTACT * contacts.slots * task.places[contact.first];
    double name = (double)(task.ids[contact.second] + 1);
    for (long long k = 0; k < contacts.slots && slot[0] != 0; k++, slot += CONTACT) {
        if (slot[0] != name) continue;
        for (int axis = 0; axis < 3; axis++) state.force[axis] = slot[1 + axis], state.rolling[axis] = slot[4 + axis];
        state.normal = slot[7], state.shares[0] = slot[8], state.shares[1] = slot[9];
        break;
    }
    turn_force(contact.axis, state.force);
    turn_force(contact.axis, state.rolling);
    return state;
}

static __device__ double normal_force(const Contacts &law, const Touching &contact)
{
    double depth = contact.overlap > 0 ? contact.overlap : 0, mean = 0.5 * (contact.radii[0] + contact.radii[1]);
    return law.stiffness * (law.is_hertz ? sqrt(contact.harmonic) * depth * sqrt(depth) : mean * depth);
}

static __device__ double normal_stiffness(const Contacts &law, const Touching &contact)
{
    double depth = contact.overlap > 0 ? contact.overlap : 0, mean = 0.5 * (contact.radii[0] + contact.radii[1]);
    return law.stiffness * (law.is_hertz ? 1.5 * sqrt(contact.harmonic * depth) : mean);
}

static __device__ double normal_resistance(const Contacts &law, const Touching &contact)
{
    return law.along * normal_stiffness(law, contact);
}

static __device__ double tangential_resistance(const Contacts &law, const Touching &contact)
{
    return law.across * law.tangential_ratio * normal_stiffness(law, contact);
}

// Implicit resistances along the line of centres, to slip, and to rolling.
static __device__ void contact_resistances(
    const Contacts &law, const Touching &contact, const ContactState &state, double resistances[CONTACT_RESISTANCES])
{
    double spring = tangential_resistance(law, contact), of_shares[2];
    for (int k = 0; k < 2; k++) of_shares[k] = state.shares[k] < 1 ? CUT * state.shares[k] * spring : spring;
    resistances[0] = normal_resistance(law, contact);
    resistances[1] = law.friction > 0 ? of_shares[0] : 0;
    resistances[2] = law.rolling_friction > 0 ? of_shares[1] : 0;
}

// Rate at which the centres are expected to separate.
static __device__ double expected_separation(const Task &task, const Contacts &contacts, const Touching &contact)
{
    if (!contacts.expected) return 0;
    double v[2][3], relative[3];
    for (int k = 0; k < 2; k++) {
        long long place = task.places[k == 0 ? contact.first : contact.second];
        relative_to_flow(contacts.positions, contacts.expected, contacts.carried, place, v[k]);
    }
    for (int axis = 0; axis < 3; axis++) relative[axis] = contacts.velocity * (v[1][axis] - v[0][axis]);
    return dot(contact.axis, relative);
}

// Velocity at which the strain of the background separates the centres.
static __device__ void strained_separation(const Contacts &contacts, const Touching &contact, double strained[3])
{
    const double *g = contacts.gradient, *x = contact.separation;
    for (int i = 0; i < 3; i++) {
        strained[i] = 0;
        for (int j = 0; j < 3; j++) strained[i] += 0.5 * contacts.rate * (g[3 * i + j] + g[3 * j + i]) * x[j];
    }
}

// Relative motion by columns of velocities and angular velocities relative to the background, which may be absent.
static __device__ ContactMotion relative_motion(
    const Task &task, const Contacts &contacts, const Touching &contact, const double *const motions[2])
{
    ContactMotion motion = {0, {0, 0, 0}, {0, 0, 0}};
    double turning[3] = {0, 0, 0}, turned[3] = {0, 0, 0}, relative[3] = {0, 0, 0};
    long long first = 3 * (long long)task.places[contact.first], second = 3 * (long long)task.places[contact.second];
    for (int axis = 0; motions[0] && axis < 3; axis++) {
        relative[axis] = contacts.velocity * (motions[0][second + axis] - motions[0][first + axis]);
        double own = contacts.rate * motions[1][first + axis], other = contacts.rate * motions[1][second + axis];
        turning[axis] = contact.arms[0] * own + contact.arms[1] * other;
        turned[axis] = contact.harmonic * (other - own);
    }
    motion.separating = dot(contact.axis, relative);
    strained_separation(contacts, contact, motion.slip);
    for (int axis = 0; axis < 3; axis++) {
        motion.slip[axis] += relative[axis] - across(turning, contact.axis, axis);
        motion.rolling[axis] = across(turned, contact.axis, axis);
    }
    flatten(contact.axis, motion.slip);
    return motion;
}

// Force on a sphere by a normal force and the state of its contact, and the torque.
static __device__ void add_contact_load(
    const Touching &contact, double normal, const ContactState &state, bool is_other, double load[SIX])
{
    double sign = is_other ? -1 : 1, lever[3];
    for (int k = 0; k < 3; k++)
        lever[k] = contact.arms[is_other ? 1 : 0] * state.force[k] + sign * contact.harmonic * state.rolling[k];
    for (int k = 0; k < 3; k++) {
        load[k] += sign * (state.force[k] - normal * contact.axis[k]);
        load[3 + k] += across(contact.axis, lever, k);
    }
}

// Adds the known part of the load of a contact on a sphere, see suspension/src/forces/contacts/prediction.rs.
static __device__ void add_known_load(const Task &task, const Contacts &contacts, const Touching &contact,
    const double resistances[CONTACT_RESISTANCES], ContactState state, bool is_other, double load[SIX])
{
    ContactMotion previous = relative_motion(task, contacts, contact, contacts.previous);
    double slides = state.shares[0] < 1 ? 1 : 0, rolls = state.shares[1] < 1 ? 1 : 0, strained[3];
    strained_separation(contacts, contact, strained);
    flatten(contact.axis, strained);
    double normal = normal_force(contacts, contact);
    normal += resistances[0] * expected_separation(task, contacts, contact);
    for (int k = 0; k < 3; k++) {
        state.force[k] += resistances[1] * (strained[k] - slides * previous.slip[k]);
        state.rolling[k] -= resistances[2] * rolls * previous.rolling[k];
    }
    add_contact_load(contact, normal, state, is_other, load);
}

// Known loads of each row, and the resistances of its contacts.
static __device__ void contact_loads(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const Contacts &contacts = *task.contacts;
    double load[SIX], largest = 0;
    for (int k = 0; k < SIX; k++) load[k] = contacts.steady ? contacts.steady[SIX * (long long)row + k] : 0;
    for (long long at = contacts.slots * row; at < contacts.slots * row + contacts.counts[row]; at++) {
        int other = contacts.others[at];
        double *resistances = contacts.resistances + CONTACT_RESISTANCES * at;
        Touching contact = contact_between(task, contacts, row, other, contacts.steps[at]);
        ContactState state = state_at_start(task, contacts, contact);
        contact_resistances(contacts, contact, state, resistances);
        add_known_load(task, contacts, contact, resistances, state, is_second(task, row, other), load);
    }
    for (int k = 0; k < SIX; k++) {
        contacts.loads[SIX * (long long)row + k] = load[k];
        if (fabs(load[k]) > largest) largest = fabs(load[k]);
    }
    unsigned long long bits = (unsigned long long)__double_as_longlong(largest);
    if (bits > *(volatile unsigned long long *)&contacts.sums->largest) atomicMax(&contacts.sums->largest, bits);
}

// Limits a force to a magnitude. Returns its share that remains.
static __device__ double limit_force(double most, double force[3])
{
    double length = sqrt(dot(force, force)), share = length > most ? most / length : 1;
    for (int k = 0; k < 3; k++) force[k] *= share;
    return share;
}

// State at the end of the substep.
static __device__ ContactState state_at_end(const Task &task, const Contacts &contacts, const Touching &contact)
{
    ContactState state = state_at_start(task, contacts, contact);
    ContactMotion motion = relative_motion(task, contacts, contact, contacts.motions);
    double separating = motion.separating - expected_separation(task, contacts, contact);
    double normal = normal_force(contacts, contact) - normal_resistance(contacts, contact) * separating;
    double spring = tangential_resistance(contacts, contact);
    state.normal = normal > 0 ? normal : 0;
    for (int k = 0; k < 3; k++) {
        state.force[k] += spring * motion.slip[k];
        state.rolling[k] += spring * motion.rolling[k];
    }
    double frictional = state.normal - contacts.critical_load;
    state.shares[0] = limit_force(contacts.friction * (frictional > 0 ? frictional : 0), state.force);
    state.shares[1] = limit_force(contacts.rolling_friction * state.normal, state.rolling);
    return state;
}

// Stores the states of the contacts of each row at the end of the substep.
static __device__ void end_contacts(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const Contacts &contacts = *task.contacts;
    double *slot = contacts.found + CONTACT * contacts.slots * task.places[row];
    for (long long k = 0; k < contacts.slots; k++, slot += CONTACT) {
        for (int i = 0; i < CONTACT; i++) slot[i] = 0;
        if (k >= contacts.counts[row]) continue;
        long long at = contacts.slots * row + k;
        int other = contacts.others[at];
        Touching contact = contact_between(task, contacts, row, other, contacts.steps[at]);
        ContactState state = state_at_end(task, contacts, contact);
        double sign = is_second(task, row, other) ? -1 : 1;
        slot[0] = (double)(task.ids[other] + 1);
        for (int i = 0; i < 3; i++) slot[1 + i] = sign * state.force[i], slot[4 + i] = state.rolling[i];
        slot[7] = state.normal, slot[8] = state.shares[0], slot[9] = state.shares[1];
    }
}
