#!/usr/bin/env bash
# Runs a scene on a machine without a queue, and goes on after each stop that asks for it:
#   nohup scripts/batch/plain.sh SCENE [arguments of fcm-solve run] > my.log 2>&1 &
# It may be called again after anything, at the machine's start too: what is finished is left alone. `kill` stops it with
# a checkpoint. After three restarts in a row that did not take a single step it gives up, with code 1. From the environment:
# LAUNCH, what starts the ranks (`mpirun`), and FCM_SOLVE, the program.
set -u
if [ $# = 0 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
# The first rank writes here how many steps it took.
steps=$PWD/.fcm-solve-$$.steps
trap 'rm -f "$steps"' EXIT
code=75 stop='' vain=0
while [ $code = 75 ] && [ -z "$stop" ]; do
    if [ $vain -gt 3 ]; then
        echo "given up after three restarts that did not take a single step: give the run more time, or look at its log" >&2
        exit 1
    fi
    rm -f "$steps"
    # shellcheck disable=SC2086
    ${LAUNCH:-mpirun} "${FCM_SOLVE:-fcm-solve}" run "$@" --continue --steps-taken "$steps" &
    run=$!
    # Open MPI's mpirun gives its ranks a second after SIGTERM; SIGUSR1 it passes on.
    trap 'stop=yes; kill -USR1 $run' TERM INT HUP
    code=128
    while [ $code -ge 128 ] && kill -0 $run 2>/dev/null; do
        wait $run
        code=$?
    done
    if [ "$(cat "$steps" 2>/dev/null || echo 0)" -gt 0 ]; then vain=0; else vain=$((vain + 1)); fi
done
exit $code
