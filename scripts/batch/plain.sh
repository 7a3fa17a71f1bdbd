#!/usr/bin/env bash
# Runs a scene on a machine without a queue, and continues it after each resumable stop:
#   nohup scripts/batch/plain.sh SCENE [arguments of fcm-solve run] > my.log 2>&1 &
# It may be called again at any time, also at the start of the machine: a finished run stays unchanged. `kill` stops it
# with a checkpoint. After three consecutive restarts without a single step it gives up, with exit code 1. Environment
# variables: LAUNCH, the command that starts the ranks (`mpirun`), and FCM_SOLVE, the program.
set -u
if [ $# = 0 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
# The first rank writes the number of steps taken to this file.
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
    # Open MPI's mpirun kills its ranks a second after SIGTERM; it forwards SIGUSR1.
    trap 'stop=yes; kill -USR1 $run' TERM INT HUP
    code=128
    while [ $code -ge 128 ] && kill -0 $run 2>/dev/null; do
        wait $run
        code=$?
    done
    if [ "$(cat "$steps" 2>/dev/null || echo 0)" -gt 0 ]; then vain=0; else vain=$((vain + 1)); fi
done
exit $code
