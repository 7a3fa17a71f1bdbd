#!/bin/sh
# Runs the sheared disks in LAMMPS and here from the same starts, and compares trajectories and speed: the start of an
# independent program, then as many of our own as there are seeds.
# Needs LAMMPS with its granular package as `lmp` (Debian: lammps). Usage: disks_lammps.sh [seeds] [rounds]
set -eu
seeds=${1:-3}
rounds=${2:-3}
here=$(cd "$(dirname "$0")" && pwd)
cargo build --quiet --release -p fcm-solve-granular --example disks_peer --manifest-path "$here/../../Cargo.toml"
ours=${CARGO_TARGET_DIR:-$here/../../target}/release/examples/disks_peer
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# user CPU seconds of a command
cpu() { # words of the command
    before=$(cut -d' ' -f16 "/proc/$$/stat")
    "$@" >out.txt
    after=$(cut -d' ' -f16 "/proc/$$/stat")
    seconds=$(awk "BEGIN { print ($after - $before) / $(getconf CLK_TCK) }")
}
independent() { # the start of an independent program in the form of LAMMPS's read_data
    awk -F, 'NR > 1 { row[NR - 1] = sprintf("%d %d %g 1 %.6f %.6f 0", NR - 1, $5 + 1, 2 * $4, $1 - 50, $2 - 50) }
        END { printf "disks\n\n%d atoms\n2 atom types\n\n-50 50 xlo xhi\n-50 50 ylo yhi\n-0.5 0.5 zlo zhi\n", NR - 1
              print "0 0 0 xy xz yz\n\nAtoms # sphere\n"
              for (k = 1; k < NR; k++) print row[k] }' "$here/../../validation/data/disks-start.csv"
}
lammps() { # time step, steps, frames apart, dump
    lmp -in "$here/disks_lammps.in" -screen none -log lammps.log -var start start.data -var viscosity 0.01 \
        -var dt "$1" -var steps "$2" -var every "$3" -var dump "$4" -var skin 3.0
}

compare() { # at time step 0.01 up to a strain of 1
    lammps 0.01 10000 2500 lammps.dump
    "$ours" run start.data 0.01 0.01 10000 2500 ours.dump >/dev/null
    "$ours" compare ours.dump lammps.dump
}

echo "Distance of the disks, start of an independent program:"
independent >start.data
compare
for seed in $(seq "$seeds"); do
    echo "Distance of the disks, seed $seed:"
    "$ours" start "$seed" start.data
    compare
done

echo "Particle-steps a CPU-second at time step 0.15, in turns:"
count=$(sed -n 's/ atoms$//p' start.data)
steps=20000
for round in $(seq "$rounds"); do
    cpu lammps 0.15 $steps $steps speed.dump
    theirs=$seconds
    cpu "$ours" run start.data 0.01 0.15 $((steps * 5)) $((steps * 5)) speed.dump
    awk "BEGIN { t = $count * $steps / $theirs; o = 5 * $count * $steps / $seconds
        printf \"LAMMPS %.2e  ours %.2e  ratio %.1f\n\", t, o, o / t }"
done
