#!/bin/sh
# Runs the sheared disks in LAMMPS and here from one start, and compares trajectories and speed.
# Needs LAMMPS with its granular package as `lmp` (Debian: lammps). Usage: disks_lammps.sh [seed] [rounds]
set -eu
seed=${1:-1}
rounds=${2:-3}
here=$(cd "$(dirname "$0")" && pwd)
cargo build --quiet --release -p drivers --example disks_peer --manifest-path "$here/../../Cargo.toml"
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
lammps() { # time step, steps, frames apart, dump
    lmp -in "$here/disks_lammps.in" -screen none -log lammps.log -var start start.data -var viscosity 0.01 \
        -var dt "$1" -var steps "$2" -var every "$3" -var dump "$4" -var skin 3.0
}

"$ours" start "$seed" start.data
echo "Distance of the disks at time step 0.01 up to a strain of 1:"
lammps 0.01 10000 2500 lammps.dump
"$ours" run start.data 0.01 0.01 10000 2500 ours.dump >/dev/null
"$ours" compare ours.dump lammps.dump

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
