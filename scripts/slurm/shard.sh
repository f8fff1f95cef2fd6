#!/usr/bin/env bash
# One task of the array of submit.sh: computes one shard, or goes on with it.
#
# USR1, which Slurm sends before the time limit, saves and requeues the task. TERM, which it sends to cancel or preempt it, saves only.
set -uo pipefail
folder=$1 stiction=$2 scene=$3 shards=$4 save_before=$5 copy_every=$6 scratch=$7
shift 7
task=$SLURM_ARRAY_TASK_ID
job=${SLURM_ARRAY_JOB_ID}_$task
shared=$folder/shards/$(printf '%0*d.shard' "${#shards}" "$task")
output=$shared
threads=${SLURM_CPUS_PER_TASK:-1}
restarts=${SLURM_RESTART_COUNT:-0}

child='' copier='' requeues='' ends=''

say() { printf '%(%F %T)T  %s\n' -1 "${*//[[:cntrl:]]/?}"; }

# The program saves at its first signal, after the batches at hand, and ends at once at the second.
stop() { [[ ! $child ]] || kill -TERM "$child" 2>/dev/null; }

# For $1 seconds at most as long as the program runs, then once more.
stop_later() {
    (
        sleep "$1"
        stop
    ) </dev/null >/dev/null 2>&1 &
}

# The half of the time that is left is enough for most batches, the other half for what is after them.
on_time_limit() {
    [[ ! $ends ]] || return
    say "the time limit is near: saves"
    requeues=1 ends=1
    stop
    stop_later $((save_before / 2))
}

# Slurm has sent it to the program too, unless the batch shell alone was meant: a second signal at once would keep it from saving.
on_end() {
    [[ ! $ends ]] || return
    say "is to end: saves"
    ends=1
    stop_later 5
}

trap on_time_limit USR1
trap on_end TERM

# What is kept beside the shard $1: its partial result, or of a sweep a file for each point that is begun, in a folder.
partials() {
    local partial
    for partial in "$1".partial "$1".points/*.h5 "$1".points/*.partial; do
        [[ ! -e $partial ]] || printf '%s\n' "$partial"
    done
}

# How many replicas are done of those of the file $1, in words that begin with their number.
progress() { "$stiction" info "$1" 2>/dev/null | sed -n '/^ *replicas there  */{s///;p;q;}'; }

# Replicas that are kept.
kept() {
    local partial words total=0
    while IFS= read -r partial; do
        words=$(progress "$partial")
        total=$((total + ${words%% *} + 0))
    done < <(partials "$output")
    echo "$total"
}

# Copies $1 to $2, which has the whole of it or what it had before.
copy() { dd if="$1" of="$2.$job" bs=1M conv=fsync status=none && mv -f -- "$2.$job" "$2"; }

# Copies what is kept from beside the shard $1 to beside the shard $2.
copy_partials() {
    local from to
    partials "$1" | while IFS= read -r from; do
        to=$2${from#"$1"}
        mkdir -p -- "${to%/*}" && copy "$from" "$to" || return 1
    done
}

# Ends at a TERM, after the file at hand, so that nothing else writes what is copied then.
keep_now_and_then() {
    (
        trap 'kill $! 2>/dev/null; exit' TERM
        while :; do
            sleep "$copy_every" &
            wait $!
            copy_partials "$output" "$shared"
        done
    ) </dev/null >/dev/null &
    copier=$!
}

# In the scratch folder: a folder of this task, with what was kept of its shard.
enter_scratch() {
    # The value of a variable of the node.
    if [[ $scratch == \$* ]]; then
        local variable=${scratch%%/*}
        variable=${variable#\$}
        [[ ${!variable-} ]] || { say "no scratch folder: \$$variable is not set on this node" && exit 1; }
        scratch=${!variable}${scratch#\$"$variable"}
    fi
    local own=$scratch/stiction-$job
    rm -rf -- "$own"
    mkdir -p -- "$own" || exit 1
    output=$own/${shared##*/}
    copy_partials "$shared" "$output" || exit 1
    keep_now_and_then
}

leave_scratch() {
    kill "$copier" 2>/dev/null
    wait "$copier" 2>/dev/null
    local code=0
    if [[ -e $output ]]; then
        copy "$output" "$shared" && rm -rf -- "$shared.partial" "$shared.points" || code=1
    else
        copy_partials "$output" "$shared" || code=1
    fi
    ((code == 0)) || say "cannot copy from ${output%/*} to ${shared%/*}"
    rm -rf -- "${output%/*}"
    return "$code"
}

tell_what_is_kept() {
    local partial
    partials "$output" | while IFS= read -r partial; do
        say "goes on: $(progress "$partial") (${partial##*/})"
    done
}

# Runs the program and leaves its exit code in `code`.
compute() {
    "$stiction" run "$scene" --shard "$task/$shards" -o "$output" --resume --threads "$threads" --quiet "$@" &
    child=$!
    # A signal that came before there was a child.
    [[ ! $ends ]] || stop
    # A wait that a trap cuts short may lose the exit code (bash 5.2 then says -1), so waits only for what has ended.
    while kill -0 "$child" 2>/dev/null; do sleep 0.2; done
    wait "$child"
    code=$?
    child=''
}

main() {
    say "shard $task of $shards on ${SLURMD_NODENAME:-$(uname -n)}, $threads threads, job $job, restarted $restarts times"
    [[ ! $scratch || -e $shared ]] || enter_scratch
    local before attempt patience=60
    before=$(kept)
    tell_what_is_kept
    for ((attempt = 1; ; attempt++)); do
        compute "$@"
        [[ ! $ends ]] || break
        # Something killed it: once may be bad luck.
        if ((code > 128 && code != 130 && attempt < 3)); then
            say "stiction was killed by signal $((code - 128)): goes on"
        # The node of the task before was given up, but works on: it ends, or is ended by Slurm.
        elif ((code == 2 && restarts > 0 && patience-- > 0)) && [[ -e ${output%/*}/.${output##*/}.lock ]]; then
            say "waits for the other process"
            attempt=0
            sleep 10
            [[ ! $ends ]] || break
        else
            break
        fi
    done
    local now
    now=$(kept)
    [[ ! $copier ]] || leave_scratch || exit 1
    if [[ ! $requeues ]] || ((code == 0)); then
        ((code == 0)) || say "ends with $code; the submit command again goes on from here"
        exit "$code"
    fi
    if ((now <= before)); then
        say "not one batch of 8 replicas in this sitting: not requeued; give more --time or --cpus-per-task"
        exit 1
    fi
    say "requeues"
    # A plain job number may mean the whole array.
    scontrol requeue "$job" || { say "cannot requeue; the submit command again goes on from here" && exit 1; }
    trap - TERM USR1
    # Slurm ends this.
    exec sleep 300
}

main "$@"
