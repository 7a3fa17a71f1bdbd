// Implicit springs of near pairs: contacts, and forces between surfaces.
#pragma once
#include "contacts.h"
#include "pair_sides.h"
#include "surface.h"

// Resistances of a pair: along the line of centres, to slip, and to rolling.
struct PairSprings {
    double along, slip, rolling;
};

// Springs of a row and an image of another particle at a distance of the centres.
static __device__ PairSprings springs_between(const Task &task, int row, int other, int packed, double distance)
{
    PairSprings springs = {surface_resistance(task, row, other, distance), 0, 0};
    if (!task.contacts || distance >= task.contacts->reach) return springs;
    const Contacts &contacts = *task.contacts;
    for (long long at = contacts.slots * row; at < contacts.slots * row + contacts.counts[row]; at++)
        if (contacts.others[at] == other && contacts.steps[at] == packed) {
            const double *resistances = contacts.resistances + CONTACT_RESISTANCES * at;
            springs.along += resistances[0], springs.slip = resistances[1], springs.rolling = resistances[2];
        }
    return springs;
}

// Adds the resistances of springs to the coefficients of a row's sphere, see hydrodynamics/src/pairs/contacts.rs.
static __device__ void add_springs(const NearKind &kind, const PairSprings &springs, double distance, SphereRow &side)
{
    bool is_larger = kind.is_larger != 0;
    double large = kind.sum - kind.small, own = is_larger ? large : kind.small, other = is_larger ? kind.small : large;
    double sign = is_larger ? -1 : 1, harmonic = 2 * kind.small * large / kind.sum;
    const double arms[2] = {distance * own / kind.sum, distance * other / kind.sum};
    double rolling = springs.rolling * harmonic * harmonic;
    for (int sphere = 0; sphere < 2; sphere++) {
        double opposite = sphere == 0 ? 1 : -1;
        side.xa[sphere] += opposite * springs.along;
        side.ya[sphere] += opposite * springs.slip;
        side.yb[sphere] += sign * springs.slip * arms[sphere];
        side.yc[sphere] += springs.slip * (arms[0] * arms[sphere]) + opposite * rolling;
    }
    side.yb_other -= sign * springs.slip * arms[0];
}
