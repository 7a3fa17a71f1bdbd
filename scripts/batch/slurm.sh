#!/usr/bin/env bash
#SBATCH --job-name=fcm-solve
#SBATCH --nodes=1
#SBATCH --ntasks=2
#SBATCH --cpus-per-task=1
#SBATCH --time=24:00:00
#SBATCH --signal=B:USR1@300
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log
# Runs a scene in as many jobs as it takes: one that ends before the scene does puts itself back into the queue.
#   sbatch scripts/batch/slurm.sh SCENE [arguments of fcm-solve run]
#   sbatch --array=1-8 scripts/batch/slurm.sh SCENE --set seed={} --out results/seed-{}
#   sbatch --array=1-8 --ntasks=1 --cpus-per-task=16 scripts/batch/slurm.sh FAMILY --part {}/8
# The last makes the runs of a family, each job an eighth of them on its cores, in one folder.
# Options of sbatch go before the script: --nodes=4 --ntasks=64 --time=12:00:00. In an array {} stands for the number of
# each job. From the environment: LAUNCH, what starts the ranks (`srun --mpi=pmix`; `srun --mpi=pmi2` for MPICH;
# `mpirun`), and FCM_SOLVE, the program. After three restarts in a row that did not take a single step the job ends, with
# code 1.
set -u
if [ $# = 0 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
launch=${LAUNCH:-srun --mpi=pmix}
# One job of an array: the number of the last of them is that of the whole array too.
job=$SLURM_JOB_ID
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then job=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; fi
arguments=("${@//\{\}/${SLURM_ARRAY_TASK_ID:-}}")
# Steps of newer Slurms do not take this over from the job.
export SRUN_CPUS_PER_TASK=${SLURM_CPUS_PER_TASK:-1}
# How many starts in a row took no step, from one start of the job to the next; and what the first rank writes there.
vain=$PWD/.fcm-solve-$SLURM_JOB_ID.vain
steps=$PWD/.fcm-solve-$SLURM_JOB_ID.steps
rm -f "$steps"

date
# shellcheck disable=SC2086
$launch "${FCM_SOLVE:-fcm-solve}" run "${arguments[@]}" --continue --walltime "$(squeue -h -j "$job" -o %L)" \
    --steps-taken "$steps" &
run=$!
# Open MPI's mpirun gives its ranks a second after SIGTERM, which may be too short for a checkpoint; SIGUSR1 it passes on.
cancelled=''
trap 'kill -USR1 $run' USR1
trap 'cancelled=yes; kill -USR1 $run' TERM
# A signal ends a wait before its time.
code=128
while [ $code -ge 128 ] && kill -0 $run 2>/dev/null; do
    wait $run
    code=$?
done
count=0
if [ "$(cat "$steps" 2>/dev/null || echo 0)" = 0 ]; then count=$(($(cat "$vain" 2>/dev/null || echo 0) + 1)); fi
rm -f "$steps" "$vain"
if [ $code = 75 ] && [ -z "$cancelled" ]; then
    if [ $count -gt 3 ]; then
        echo "given up after three restarts that did not take a single step: give the run more time, or look at its log" >&2
        exit 1
    fi
    echo $count > "$vain"
    echo "back into the queue, time $((${SLURM_RESTART_COUNT:-0} + 1))"
    scontrol requeue "$job"
fi
exit $code
