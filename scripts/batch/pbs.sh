#!/usr/bin/env bash
#PBS -N fcm-solve
#PBS -l select=1:ncpus=2:mpiprocs=2
#PBS -l walltime=24:00:00
#PBS -j oe
# Runs a scene in as many jobs as it takes: one that ends before the scene does submits another.
#   qsub -v SCENE=my.toml,WALLTIME=23:50:00 scripts/batch/pbs.sh
# The folder where qsub is called is that of the paths. From the environment, through -v: SCENE; WALLTIME, somewhat less
# than the job's; ARGUMENTS, further ones of fcm-solve run, of which none has a blank; LAUNCH, what starts the ranks
# (`mpirun`); FCM_SOLVE, the program; SCRIPT, this file, which PBS copies before it is run.
set -u
cd "$PBS_O_WORKDIR" || exit 1
script=${SCRIPT:-scripts/batch/pbs.sh}
launch=${LAUNCH:-mpirun}

date
# shellcheck disable=SC2086
$launch "${FCM_SOLVE:-fcm-solve}" run "$SCENE" ${ARGUMENTS:-} --continue --walltime "${WALLTIME:-23:50:00}" &
run=$!
# Open MPI's mpirun gives its ranks a second after SIGTERM, which may be too short for a checkpoint; SIGUSR1 it passes on.
trap 'kill -USR1 $run' USR1 TERM
code=128
while [ $code -ge 128 ] && kill -0 $run 2>/dev/null; do
    wait $run
    code=$?
done
if [ $code = 75 ]; then
    qsub -V "$script"
fi
exit $code
