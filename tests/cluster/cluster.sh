#!/usr/bin/env bash
# A bake as a Slurm array and under Open MPI's launcher, on this machine: the maps must be the bytes of the local one.
# One task of the array is lost on purpose. Slurm runs privately: its own key, ports, folders; nothing is left.
#
# usage: cluster.sh PROGRAM MESH WORK_DIRECTORY. Needs slurm-wlm, munge and openmpi-bin; exit status 77 without them.
set -euo pipefail

frm=$(realpath "$1")
mesh=$(realpath "$2")
work=$3
options=(--quality draft --directions 18 --resolution 6 --sources 6)

for tool in munged slurmctld slurmd sbatch squeue scancel mpirun; do
    if ! PATH=$PATH:/usr/sbin command -v "$tool" >/dev/null; then
        echo "skipped: $tool is not installed (scripts/test --full installs it)"
        exit 77
    fi
done
PATH=$PATH:/usr/sbin

fail() {
    echo "wrong: $*" >&2
    tail -n 20 "$work"/slurm/*.log >&2 || true
    exit 1
}

pids=()
stop_all() {
    local pid
    # The first started is needed by the others to the end.
    for ((i = ${#pids[@]} - 1; i >= 0; --i)); do
        pid=${pids[i]}
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
}
trap stop_all EXIT

# until_true SECONDS COMMAND...: waits for it.
until_true() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.1
    done
}

start_slurm() {
    local slurm=$work/slurm host user
    host=$(hostname -s)
    user=$(id -un)
    mkdir -p "$slurm"/{state,spool}
    # munged takes a socket only in a folder that all may enter and that nobody else may write to.
    chmod 755 "$slurm"
    dd if=/dev/urandom of="$slurm/munge.key" bs=1024 count=1 status=none
    chmod 400 "$slurm/munge.key"
    cat >"$slurm/slurm.conf" <<END
ClusterName=frm
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.socket
CredType=cred/munge
SlurmctldPort=26817
SlurmdPort=26818
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=test Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
    export SLURM_CONF=$slurm/slurm.conf
    munged --foreground --force --key-file="$slurm/munge.key" --socket="$slurm/munge.socket" \
        --pid-file="$slurm/munged.pid" --log-file="$slurm/munged.log" --seed-file="$slurm/munged.seed" \
        --num-threads=2 2>"$slurm/munged.err.log" &
    pids+=($!)
    until_true 20 test -S "$slurm/munge.socket" || fail "munged does not start"
    slurmctld -D -i >/dev/null 2>"$slurm/slurmctld.err.log" &
    pids+=($!)
    slurmd -D -N "$host" >/dev/null 2>"$slurm/slurmd.err.log" &
    pids+=($!)
    until_true 60 node_is_idle || fail "the Slurm node does not come up"
}

node_is_idle() { [ "$(sinfo -h -o %t)" = idle ]; }
job_runs() { [ -n "$(squeue -h -t R -j "$1")" ]; }
job_is_gone() { [ -z "$(squeue -h -j "$1" 2>/dev/null)" ]; }
flows() { find "$1" -name 'task-*.flow' | wc -l; }

# solve_array TASKS: one job a task, as a user would submit it.
solve_array() {
    sbatch --parsable --array="$1" --ntasks=1 --cpus-per-task=1 --output="$work/slurm-%A_%a.out" \
        --wrap "'$frm' bake solve '$work/jobs'"
}

by_slurm() {
    local id tasks status began=$SECONDS loops=0 victim
    "$frm" bake plan "$mesh" -o "$work/jobs" "${options[@]}" 2>/dev/null
    tasks=$("$frm" bake merge "$work/jobs" -o "$work/slurm.frm" 2>/dev/null) && fail "merged without a flow"
    id=$(solve_array "$tasks")
    # A task is lost: killed in the middle by its number in the array.
    until_true 60 job_runs "$id" || fail "no task of the array runs"
    victim=$(squeue -h -t R -r -j "$id" -o %K | head -n 1)
    scancel --signal=KILL "${id}_$victim"
    until_true 300 job_is_gone "$id" || fail "the array does not end"
    echo "array of $tasks: $(flows "$work/jobs") of 18 flows; element $victim was killed"
    # The loop of docs/bake-jobs.md, with squeue in place of the slower sbatch --wait.
    until tasks=$("$frm" bake merge "$work/jobs" -o "$work/slurm.frm" 2>"$work/merge.err"); do
        status=$?
        [ "$status" -ge 3 ] || fail "frm bake merge: status $status: $(cat "$work/merge.err")"
        loops=$((loops + 1))
        [ "$loops" -le 3 ] || fail "it never ends: $(cat "$work/merge.err")"
        echo "status $status: $(tail -n 1 "$work/merge.err")"
        id=$(solve_array "$tasks")
        until_true 300 job_is_gone "$id" || fail "the array does not end"
    done
    [ "$loops" -ge 1 ] || fail "the killed task was not missed"
    echo "$tasks"
    cmp "$work/slurm.frm" "$work/local.frm" || fail "the map of the array is not the local map"
    echo "Slurm $(sinfo --version | cut -d' ' -f2): the same bytes as the local map, in $((SECONDS - began)) s"
}

by_mpi() {
    local began=$SECONDS lines
    "$frm" bake plan "$mesh" -o "$work/ranks" "${options[@]}" 2>/dev/null
    mpirun --oversubscribe --allow-run-as-root --tag-output -n 3 "$frm" bake solve "$work/ranks" \
        >"$work/mpi.out" 2>"$work/mpi.err" || fail "mpirun: $(cat "$work/mpi.err")"
    lines=$(grep -c ': done in' "$work/mpi.out") || fail "no rank solved anything"
    [ "$lines" -eq 18 ] || fail "$lines flows were solved, not 18"
    for rank in 0 1 2; do
        echo "rank $rank: $(grep "^\[1,$rank\]" "$work/mpi.out" | sed 's/.*task \([0-9]*\) .*/\1/' | sort -n | xargs)"
    done
    "$frm" bake merge "$work/ranks" -o "$work/mpi.frm" 2>"$work/merge.err" || fail "merge: $(cat "$work/merge.err")"
    cmp "$work/mpi.frm" "$work/local.frm" || fail "the map of the ranks is not the local map"
    echo "$(mpirun --version | head -n 1): the same bytes as the local map, in $((SECONDS - began)) s"
}

rm -rf "$work"
mkdir -p "$work"
work=$(realpath "$work")
"$frm" bake "$mesh" -o "$work/local.frm" "${options[@]}" 2>/dev/null
start_slurm
by_slurm
by_mpi
