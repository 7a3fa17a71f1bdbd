#!/usr/bin/env bash
#PBS -N fcm-solve
#PBS -l select=1:ncpus=2:mpiprocs=2
#PBS -l walltime=24:00:00
#PBS -j oe
# Runs a scene in as many jobs as necessary: a job that ends before the run submits another.
#   qsub -v SCENE=my.toml,WALLTIME=23:50:00 scripts/batch/pbs.sh
# An array makes the runs of a family, each job an eighth of them on its cores, in one folder:
#   qsub -J 1-8 -l select=1:ncpus=16:mpiprocs=1 -v SCENE=family.toml,ARGUMENTS='--part {}/8' scripts/batch/pbs.sh
# Paths are relative to the folder where qsub is called. Environment variables, through -v: SCENE; WALLTIME, slightly less
# than that of the job; ARGUMENTS, further arguments of fcm-solve run without blanks, in which {} is replaced by the index
# of each job of an array; LAUNCH, the command that starts the ranks (`mpirun`); FCM_SOLVE, the program; SCRIPT, this file,
# which PBS copies before it runs it. After three consecutive jobs without a single step no more are submitted, and the exit
# code is 1; their number is passed on as VAIN.
set -u
cd "$PBS_O_WORKDIR" || exit 1
script=${SCRIPT:-scripts/batch/pbs.sh}
launch=${LAUNCH:-mpirun}
# A job that submits another one passes its number on.
export ARGUMENTS="${ARGUMENTS:-}"
ARGUMENTS=${ARGUMENTS//\{\}/${PBS_ARRAY_INDEX:-}}
# The first rank writes the number of steps taken to this file.
steps=$PWD/.fcm-solve-${PBS_JOBID:-$$}.steps
trap 'rm -f "$steps"' EXIT

date
# shellcheck disable=SC2086
$launch "${FCM_SOLVE:-fcm-solve}" run "$SCENE" ${ARGUMENTS:-} --continue --walltime "${WALLTIME:-23:50:00}" \
    --steps-taken "$steps" &
run=$!
# Open MPI's mpirun kills its ranks a second after SIGTERM, which may be too short for a checkpoint; it forwards SIGUSR1.
trap 'kill -USR1 $run' USR1 TERM
code=128
while [ $code -ge 128 ] && kill -0 $run 2>/dev/null; do
    wait $run
    code=$?
done
if [ $code = 75 ]; then
    if [ "$(cat "$steps" 2>/dev/null || echo 0)" -gt 0 ]; then VAIN=0; else VAIN=$((${VAIN:-0} + 1)); fi
    if [ "$VAIN" -gt 3 ]; then
        echo "given up after three restarts that did not take a single step: give the run more time, or look at its log" >&2
        exit 1
    fi
    export VAIN
    qsub -V "$script"
fi
exit $code
