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
# Runs a scene in as many jobs as necessary: a job that ends before the run puts itself back into the queue.
#   sbatch scripts/batch/slurm.sh SCENE [arguments of fcm-solve run]
#   sbatch --array=1-8 scripts/batch/slurm.sh SCENE --set seed={} --out results/seed-{}
#   sbatch --array=1-8 --ntasks=1 --cpus-per-task=16 scripts/batch/slurm.sh FAMILY --part {}/8
# The last makes the runs of a family, each job an eighth of them on its cores, in one folder.
# Options of sbatch go before the script: --nodes=4 --ntasks=64 --time=12:00:00. In an array {} is replaced by the index of
# each job. Environment variables: LAUNCH, the command that starts the ranks (`srun --mpi=pmix`; `srun --mpi=pmi2` for
# MPICH; `mpirun`), and FCM_SOLVE, the program. After three consecutive restarts without a single step the job ends, with
# exit code 1.
set -u
if [ $# = 0 ]; then
    sed -n 's/^#   //p' "$0" >&2
    exit 2
fi
launch=${LAUNCH:-srun --mpi=pmix}
# One job of an array: the id of the last of them is also that of the whole array.
job=$SLURM_JOB_ID
if [ -n "${SLURM_ARRAY_TASK_ID:-}" ]; then job=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID; fi
arguments=("${@//\{\}/${SLURM_ARRAY_TASK_ID:-}}")
# Steps of newer versions of Slurm do not inherit this from the job.
export SRUN_CPUS_PER_TASK=${SLURM_CPUS_PER_TASK:-1}
# Number of consecutive starts without a step, kept between restarts of the job; and the file that the first rank writes.
vain=$PWD/.fcm-solve-$SLURM_JOB_ID.vain
steps=$PWD/.fcm-solve-$SLURM_JOB_ID.steps
rm -f "$steps"

date
# shellcheck disable=SC2086
$launch "${FCM_SOLVE:-fcm-solve}" run "${arguments[@]}" --continue --walltime "$(squeue -h -j "$job" -o %L)" \
    --steps-taken "$steps" &
run=$!
# Open MPI's mpirun kills its ranks a second after SIGTERM, which may be too short for a checkpoint; it forwards SIGUSR1.
cancelled=''
trap 'kill -USR1 $run' USR1
trap 'cancelled=yes; kill -USR1 $run' TERM
# A signal interrupts `wait`.
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
    echo "requeued, restart $((${SLURM_RESTART_COUNT:-0} + 1))"
    scontrol requeue "$job"
fi
exit $code
