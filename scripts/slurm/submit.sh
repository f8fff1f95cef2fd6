#!/usr/bin/env bash
# An experiment on a Slurm cluster: a job array that computes its shards, and a job after them that merges and validates. docs/cluster.md
#
# Usage: submit.sh SCENE.toml --shards N [options] [options of sbatch]
#
#   --shards N              the tasks of the array; each computes one shard, whole batches of 8 replicas
#   --output FOLDER         where everything goes, on a file system that all nodes share; default: the scene's name, in the current folder
#   --stiction PATH         the program; default: stiction on the PATH. Its full path is what the nodes run
#   --seed SEED, --replicas COUNT
#                           instead of the scene's
#   --checkpoint SECONDS    how often a task keeps what it has done; default: 30
#   --at-once M             at most M tasks at a time
#   --save-before SECONDS   save and requeue a task this long before its time limit; default: 120
#   --scratch FOLDER        compute in a folder of the node, such as /local or '$TMPDIR' (in single quotes: the node's), and copy what has been
#                           done to the output folder; default: compute in the output folder
#   --copy-every SECONDS    how often that is copied besides at the end of each sitting; default: 300
#   --merge-time TIME, --merge-mem MEMORY
#                           --time and --mem of the merge; default: as for the array
#
# Everything else is for the sbatch of the array: --time, --cpus-per-task, --mem, --partition, --account and so on. The merge gets the
# ones that say who, where, how long and how much memory.
#
# This command again completes what is not complete, and computes nothing twice.
#
# Exit codes: 0 submitted, or nothing to submit; 1 Slurm refused; 2 the command is wrong, and nothing was written or submitted.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)

# A text without what would steer the terminal.
shown() { printf '%s' "${*//[[:cntrl:]]/?}"; }

refuse() {
    printf 'submit.sh: %s\n' "$(shown "$*")" >&2
    exit 2
}

fail() {
    printf 'submit.sh: %s\n' "$(shown "$*")" >&2
    exit 1
}

is_count() { [[ $1 =~ ^[1-9][0-9]{0,8}$ ]]; }

# Long options of sbatch that the merge gets too, with their short forms. Memory and time are among them unless the merge has its own.
shared_options=(account=A comment= constraint=C exclude=x export= mail-type= mail-user= mem= mem-per-cpu= nodelist=w
    partition=p qos=q reservation= time=t wckey=)

read_arguments() {
    command_line=$(printf 'cd %q &&' "$PWD" && printf ' %q' "$0" "$@")
    scene='' shards='' output='' program=stiction seed='' replicas='' checkpoint='' at_once='' save_before=120 scratch='' copy_every=300
    merge_time='' merge_mem='' for_array=() for_merge=()
    case ${1-} in
    --help | -h)
        sed -n '2,/^set -/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
        exit 0
        ;;
    '') refuse "no scene: submit.sh SCENE.toml --shards N; --help tells more" ;;
    -*) refuse "the scene comes first, and not $1: submit.sh SCENE.toml --shards N" ;;
    esac
    scene=$1
    shift
    local name value takes_value=''
    while (($#)); do
        name=${1%%=*}
        case $name in
        --shards | --output | --stiction | --seed | --replicas | --checkpoint | --at-once | --save-before | --scratch | --copy-every | --merge-time | --merge-mem)
            if [[ $1 == *=* ]]; then
                value=${1#*=}
            else
                (($# > 1)) || refuse "$name has no value"
                value=$2
                shift
            fi
            [[ $value ]] || refuse "$name has no value"
            set_own "$name" "$value"
            takes_value=''
            ;;
        --array | --wrap | --open-mode | --parsable | --chdir | -a* | -D* | -o*)
            refuse "$1 is set by submit.sh; which shards there are is --shards, how many at once --at-once, the folder --output"
            ;;
        --clusters | -M*) refuse "$1: submit where that cluster is, or export SLURM_CLUSTERS" ;;
        --wait | -W | --test-only) refuse "$1: the merge is submitted along with the array" ;;
        --signal) refuse "$1 is set by submit.sh; give --save-before SECONDS" ;;
        --dependency | -d*) refuse "$1: the merge waits for the array, and the array for nothing" ;;
        -*)
            for_array+=("$1")
            takes_value=''
            [[ $1 == *=* ]] || takes_value=1
            ;;
        *)
            [[ $takes_value ]] || refuse "$1 is neither an option nor the value of one"
            for_array+=("$1")
            takes_value=''
            ;;
        esac
        shift
    done
    choose_for_merge
}

set_own() {
    case $1 in
    --shards) shards=$2 ;;
    --output) output=$2 ;;
    --stiction) program=$2 ;;
    --seed) seed=$2 ;;
    --replicas) replicas=$2 ;;
    --checkpoint) checkpoint=$2 ;;
    --at-once) at_once=$2 ;;
    --save-before) save_before=$2 ;;
    --scratch) scratch=$2 ;;
    --copy-every) copy_every=$2 ;;
    --merge-time) merge_time=$2 ;;
    --merge-mem) merge_mem=$2 ;;
    esac
}

# Of the options of the array, those that the merge gets too.
choose_for_merge() {
    local index option long short
    for ((index = 0; index < ${#for_array[@]}; index++)); do
        option=${for_array[index]}
        for long in "${shared_options[@]}"; do
            short=${long#*=} long=${long%=*}
            [[ $merge_time && $long == time || $merge_mem && $long == mem* ]] && continue
            case $option in
            --"$long" | -"${short:-?}")
                if ((index + 1 < ${#for_array[@]})); then
                    for_merge+=("$option" "${for_array[index + 1]}")
                    index=$((index + 1))
                fi
                break
                ;;
            --"$long"=*) for_merge+=("$option") && break ;;
            --*) ;;
            -"${short:-?}"?*) for_merge+=("$option") && break ;;
            esac
        done
    done
    [[ ! $merge_time ]] || for_merge+=("--time=$merge_time")
    [[ ! $merge_mem ]] || for_merge+=("--mem=$merge_mem")
}

check_arguments() {
    [[ $shards ]] || refuse "no --shards: how many tasks compute the experiment, such as --shards 16"
    is_count "$shards" || refuse "--shards $shards: a whole number from 1, such as 16"
    [[ ! $at_once ]] || is_count "$at_once" || refuse "--at-once $at_once: a whole number from 1"
    [[ ! $replicas ]] || is_count "$replicas" || refuse "--replicas $replicas: a whole number from 1"
    [[ ! $seed || $seed =~ ^[0-9]+$ ]] || refuse "--seed $seed: a whole number from 0"
    [[ ! $checkpoint || $checkpoint == 0 ]] || is_count "$checkpoint" || refuse "--checkpoint $checkpoint: seconds, a whole number from 0"
    { is_count "$save_before" && ((save_before <= 65535)); } || refuse "--save-before $save_before: seconds, from 1 to 65535"
    is_count "$copy_every" || refuse "--copy-every $copy_every: seconds, a whole number from 1"
    [[ -f $scene && -r $scene ]] || refuse "$scene: no such scene that can be read"
    # shellcheck disable=SC2016 # a name of the node's
    [[ ! $scratch || $scratch == /* || $scratch =~ ^\$[A-Za-z_][A-Za-z_0-9]*(/.*)?$ ]] ||
        refuse "--scratch $scratch: a folder of the nodes that begins with / or with a variable, such as /local or '\$TMPDIR'"
    for needed in sbatch squeue scontrol scancel; do
        command -v "$needed" >/dev/null || refuse "no $needed on the PATH: this is for a machine that submits to Slurm"
    done
    for_run=()
    [[ ! $seed ]] || for_run+=(--seed "$seed")
    [[ ! $replicas ]] || for_run+=(--replicas "$replicas")
    check_program
    check_scene
}

check_program() {
    local found
    found=$(command -v -- "$program") || refuse "--stiction $program: no such program; give the path of stiction"
    program=$(realpath -- "$found")
    [[ -x $program ]] || refuse "--stiction $program: not a program"
    local help
    help=$("$program" run --help 2>/dev/null) || true
    [[ $help == *--shard* ]] || refuse "--stiction $program: not a stiction that knows run --shard"
}

# A shard of so many that it is empty computes nothing, and is refused what any shard of this scene would be refused.
check_scene() {
    local trial message
    trial=$(mktemp -d)
    message=$("$program" run "$scene" --shard 1/1000000 -o "$trial/shard.h5" --quiet "${for_run[@]}" 2>&1 >/dev/null) || {
        rm -rf -- "$trial"
        printf '%s\n' "$message" >&2
        exit 2
    }
    rm -rf -- "$trial"
}

# What all that is ever computed in the folder has in common.
experiment() {
    printf 'scene      %s\n' "$scene"
    printf 'checksum   %s\n' "$(cksum <"$scene")"
    printf 'shards     %s\n' "$shards"
    printf 'seed       %s\n' "${seed:-of the scene}"
    printf 'replicas   %s\n' "${replicas:-of the scene}"
}

# Names the folder, and makes sure that it is new or holds this experiment.
check_folder() {
    scene=$(realpath -- "$scene")
    name=$(basename -- "$scene" .toml)
    output=$(realpath -m -- "${output:-$name}")
    result=$output/$name.h5
    [[ $output$scene != *$'\n'* ]] || refuse "a line break in the path of the scene or of the output"
    if [[ -e $output/experiment ]]; then
        local key kept asked
        while read -r key kept <&3 && read -r key asked <&4; do
            [[ $kept == "$asked" ]] && continue
            [[ $key == checksum ]] && refuse "$scene has changed since $output was begun; give another --output"
            refuse "$output holds an experiment whose $key is $kept, and not $asked; give that, or another --output"
        done 3<"$output/experiment" 4< <(experiment)
    elif [[ -e $output ]]; then
        [[ -d $output ]] || refuse "--output $output: not a folder"
        [[ ! $(ls -A -- "$output") ]] || refuse "--output $output: a folder that is neither empty nor an experiment of submit.sh"
    fi
}

# Shards that are neither complete nor in the queue: `todo`. Arrays and merges of former submissions in the queue: `arrays`, `merges`.
look_for_the_rest() {
    declare -gA queued=() arrays=()
    declare -ga merges=() todo=()
    local queue kind job task state index
    declare -A kinds=()
    if [[ -e $output/jobs ]]; then
        while read -r kind job; do kinds[$job]=$kind; done <"$output/jobs"
        queue=$(squeue --noheader --array --user="$(id -un)" --format='%F %K %T') || fail "squeue failed, so what is in the queue is not known"
        while read -r job task state; do
            # Tasks that are coming to their end have done what they could.
            [[ $state != COMPLETING ]] || continue
            kind=${kinds[${job:-none}]-}
            case $kind in
            array) queued[$task]=$job arrays[$job]=1 ;;
            merge) merges+=("$job") ;;
            esac
            [[ $kind != merge || $state == PENDING ]] || refuse "job $job merges $output at this moment; wait for it, or scancel $job"
        done <<<"$queue"
    fi
    for ((index = 1; index <= shards; index++)); do
        [[ -e $(shard "$index") || ${queued[$index]-} ]] || todo+=("$index")
    done
}

# The file of a shard. shard.sh and merge.sh name it likewise.
shard() { printf '%s/shards/%0*d.shard' "$output" "${#shards}" "$1"; }

# Numbers in ascending order as Slurm writes them: 3,7-9,12.
ranges() {
    local first='' last='' number text=''
    for number in "$@" ''; do
        if [[ $last && $number == $((last + 1)) ]]; then
            last=$number
            continue
        fi
        [[ ! $first ]] || text+=${text:+,}$first
        [[ $first == "$last" ]] || text+=-$last
        first=$number last=$number
    done
    printf '%s' "$text"
}

check_size_of_array() {
    local most
    most=$(scontrol show config | sed -n 's/^MaxArraySize *= *\([0-9]*\).*/\1/p') || true
    [[ $most ]] || fail "Slurm does not answer to scontrol show config"
    ((most > 0)) || refuse "this cluster has no job arrays (its MaxArraySize is 0)"
    # The largest index is one less.
    ((shards < most)) || refuse "--shards $shards: at most $((most - 1)) on this cluster (its MaxArraySize is $most); a task may have several cores, --cpus-per-task"
}

# The number of a job, of what sbatch --parsable says: with clusters or without.
number_of() {
    [[ $1 =~ ^([0-9]+)(;.*)?$ ]] || fail "sbatch names no job, but says: $1"
    printf '%s' "${BASH_REMATCH[1]}"
}

submit_array() {
    local indices
    indices=$(ranges "${todo[@]}")${at_once:+%$at_once}
    [[ ! $checkpoint ]] || for_run+=(--checkpoint "$checkpoint")
    array=$(sbatch --parsable --job-name="stiction-$name" --nodes=1 --ntasks=1 --requeue "${for_array[@]}" \
        --array="$indices" --signal="B:USR1@$save_before" --open-mode=append --chdir="$output" --output="logs/shard-%${#shards}a.log" \
        "$here/shard.sh" "$output" "$program" "$scene" "$shards" "$save_before" "$copy_every" "$scratch" "${for_run[@]}") || {
        [[ -e $output/jobs ]] || (cd -- "$output" && rm -f experiment && rmdir shards logs "$output")
        fail "sbatch refused the array; nothing was submitted"
    }
    array=$(number_of "$array")
    printf 'array %s\n' "$array" >>"$output/jobs"
}

# Former tasks may have failed, which a dependency on their success would never forgive: it is the merge that finds what is missing.
submit_merge() {
    local dependency='' job
    ((!${#todo[@]})) || dependency=afterok:$array
    for job in "${!arrays[@]}"; do dependency+=${dependency:+,}afterany:$job; done
    merge=$(sbatch --parsable --job-name="stiction-$name-merge" --nodes=1 --ntasks=1 --requeue "${for_merge[@]}" \
        ${dependency:+"--dependency=$dependency"} --kill-on-invalid-dep=yes --open-mode=append --chdir="$output" --output=logs/merge.log \
        "$here/merge.sh" "$output" "$program" "$result" "$shards") || {
        ((!${#todo[@]})) || scancel "$array"
        fail "sbatch refused the merge${array:+, so its array $array was cancelled}"
    }
    merge=$(number_of "$merge")
    printf 'merge %s\n' "$merge" >>"$output/jobs"
}

list() {
    local IFS=,
    printf '%s' "$*"
}

report() {
    local complete=$((shards - ${#todo[@]} - ${#queued[@]}))
    printf 'shards    %d, of which %d complete, %d in the queue before, %d submitted%s\n' \
        "$shards" "$complete" "${#queued[@]}" "${#todo[@]}" "${array:+ as job $array}"
    printf 'merge     job %s, after them: %s\n' "$merge" "$(shown "$result")"
    printf 'logs      %s\n' "$(shown "$output/logs")"
    printf 'watch     squeue --jobs=%s\n' "$(list ${array:+"$array"} "${!arrays[@]}" "$merge")"
    printf 'restart   %s\n' "$command_line"
}

main() {
    read_arguments "$@"
    check_arguments
    check_folder
    check_size_of_array
    look_for_the_rest
    if ((!${#todo[@]} && ${#merges[@]})); then
        printf 'shards    %d, all of them complete or in the queue, and the merge too: nothing submitted\n' "$shards"
        printf 'watch     squeue --jobs=%s\n' "$(list "${!arrays[@]}" "${merges[@]}")"
        exit 0
    fi
    mkdir -p -- "$output/shards" "$output/logs"
    experiment >"$output/experiment"
    array=''
    ((!${#todo[@]})) || submit_array
    # A former merge would miss what the new array computes.
    ((!${#merges[@]})) || scancel "${merges[@]}" || true
    submit_merge
    report
}

main "$@"
