#!/usr/bin/env bash
# What docs/cluster.md promises, on a Slurm cluster of four nodes that this makes on one host, for itself: without systemd, on free ports of
# loopback, in a temporary folder. Installs Debian's slurmctld, slurmd, slurm-client and munge where they are missing. Takes some minutes.
#
# Usage: test_cluster.sh [PATH OF stiction]     default: target/release/stiction; $PYTHON is a Python with h5py, made if there is none
#
# Exit codes: 0 all held; 1 something did not, and the folder stays with its logs; 77 skipped, because Slurm is not there and cannot be
# installed, or does not start on this host; it says which.
set -euo pipefail
exec </dev/null

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
root=$(cd "$here/../.." && pwd -P)
stiction=$(realpath -- "${1:-$root/target/release/stiction}")
scene=$root/configs/case_ii.toml
host=$(uname -n)
host=${host%%.*}
# Most seconds of all.
readonly deadline=570

folder='' daemons=()

check() {
    local what=$1
    shift
    if "$@"; then
        printf 'ok    %4d s  %s\n' "$SECONDS" "$what"
    else
        printf 'FAIL  %4d s  %s\n' "$SECONDS" "$what"
        exit 1
    fi
}

# Waits until a command succeeds.
wait_for() {
    local most=$1
    shift
    local end=$((SECONDS + most))
    until "$@"; do
        ((SECONDS < end && SECONDS < deadline)) || return 1
        sleep 0.2
    done
}

# --- What is needed

install_slurm() {
    local missing=() program
    for program in slurmctld slurmd munged sbatch; do
        [[ -x $(command -v "$program") || -x /usr/sbin/$program ]] || missing+=("$program")
    done
    ((${#missing[@]})) || return 0
    local as_root=()
    if ((EUID != 0)); then
        sudo -n true 2>/dev/null || skip "no ${missing[*]}, and no root or sudo without a password to install them"
        as_root=(sudo -n)
    fi
    command -v apt-get >/dev/null || skip "no ${missing[*]}, and no apt-get to install them"
    local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq install --yes --no-install-recommends slurmctld slurmd slurm-client munge)
    "${install[@]}" >"$folder/apt.log" 2>&1 || { "${as_root[@]}" apt-get -qq update && "${install[@]}"; } >>"$folder/apt.log" 2>&1 ||
        skip "no ${missing[*]}, and apt-get cannot install them: $(tail -n 1 "$folder/apt.log")"
}

skip() {
    printf 'skipped: %s\n' "$*"
    exit 77
}

find_python() {
    python=${PYTHON:-python3}
    if ! "$python" -c 'import h5py' 2>/dev/null; then
        { python3 -m venv "$folder/venv" && "$folder/venv/bin/python" -m pip install --quiet --disable-pip-version-check h5py; } ||
            skip "no Python with h5py, and none can be made"
        python=$folder/venv/bin/python
    fi
}

# --- The cluster

# Five ports, one after the other, that nothing listens to.
free_ports() {
    local offset
    for _ in {1..100}; do
        port=$((20000 + RANDOM % 10000))
        for offset in {0..4}; do
            ! (exec 3<>"/dev/tcp/127.0.0.1/$((port + offset))") 2>/dev/null || continue 2
        done
        return
    done
    return 1
}

configure() {
    mkdir "$folder"/{munge,state,spool,log}
    chmod 755 "$folder" "$folder/munge"
    (umask 077 && head -c 1024 /dev/urandom >"$folder/munge/key")
    cat >"$folder/slurm.conf" <<END
ClusterName=stiction
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
# A requeued job waits for as long as credentials live.
AuthInfo=socket=$folder/munge/socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/log/slurmctld.log
SlurmdLogFile=$folder/log/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=bf_interval=2,sched_interval=2
# Seconds until a node that does not answer is given up.
SlurmdTimeout=10
ReturnToService=2
SlurmdParameters=config_overrides
MailProg=/bin/true
END
    local index
    for index in 1 2 3 4; do
        mkdir "$folder/spool/node$index"
        echo "NodeName=node$index NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + index)) CPUs=1 RealMemory=1000"
    done >>"$folder/slurm.conf"
    echo "PartitionName=main Nodes=node[1-4] Default=YES MaxTime=INFINITE State=UP" >>"$folder/slurm.conf"
    export SLURM_CONF=$folder/slurm.conf PATH=$PATH:/usr/sbin:/sbin
}

start() {
    "$@" >>"$folder/log/output" 2>&1 &
    daemons+=($!)
    # The shell need not say that one was killed.
    disown
}

start_cluster() {
    start munged --foreground --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
        --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
    wait_for 20 test -S "$folder/munge/socket" || return 1
    start slurmctld -D -c
    local index
    for index in 1 2 3 4; do
        start_node "$index"
    done
    wait_for 60 nodes_are idle 4
}

nodes_are() { [[ $(sinfo --noheader --Node --format=%T 2>/dev/null | grep -cx "$1") == "$2" ]]; }

# Whether a node answers: its state is not down, and has no star.
node_answers() { [[ $(sinfo --noheader --nodes="node$1" --format=%T 2>/dev/null) =~ ^(idle|mixed|allocated|completing)$ ]]; }

# Processes that have a line in their environment.
processes_with() { grep -lzFx -- "$1" /proc/[0-9]*/environ 2>/dev/null | sed 's|/proc/\([0-9]*\)/.*|\1|' || true; }

kill_now() { (($# == 0)) || kill -KILL "$@" 2>/dev/null || true; }

# Processes of the jobs on a node of this cluster.
on_node() { comm -12 <(processes_with "SLURMD_NODENAME=node$1" | sort) <(processes_with "SLURM_CONF=$SLURM_CONF" | sort); }

# A node loses its power: its jobs, what watches them, which is the parent of their scripts, and its slurmd.
kill_node() {
    local process parent jobs
    mapfile -t jobs < <(on_node "$1")
    kill_now "${slurmd[$1]}"
    for process in "${jobs[@]}"; do
        parent=$(sed -n 's/^PPid:\t//p' "/proc/$process/status" 2>/dev/null) || true
        [[ $(cat "/proc/${parent:-0}/comm" 2>/dev/null) != slurmstepd* ]] || kill_now "$parent"
    done
    kill_now "${jobs[@]}"
}

start_node() {
    start slurmd -D -N "node$1"
    slurmd[$1]=${daemons[-1]}
}

# Looks for a stiction on a node that has kept something, and stops it there: its `process`, and the `shard` that it makes.
holds_process_on() {
    local arguments index
    for process in $(on_node "$1"); do
        mapfile -t -d '' arguments 2>/dev/null <"/proc/$process/cmdline" || continue
        for ((index = 1; index < ${#arguments[@]}; index++)); do
            shard=${arguments[index]}
            [[ ${arguments[index - 1]} == -o ]] || continue
            kill -STOP "$process" 2>/dev/null || continue 2
            [[ ! -e $shard.partial || -e $shard ]] || return 0
            kill -CONT "$process" 2>/dev/null || true
        done
    done
    return 1
}

clean_up() {
    local code=$?
    trap - EXIT
    # Nothing of another Slurm.
    [[ ${SLURM_CONF-} != "$folder"/* ]] || scancel --user="$(id -un)" >/dev/null 2>&1 || true
    ((!${#daemons[@]})) || kill "${daemons[@]}" 2>/dev/null || true
    sleep 1
    ((!${#daemons[@]})) || kill_now "${daemons[@]}"
    # What was not a child of this.
    # shellcheck disable=SC2046
    [[ ${SLURM_CONF-} != "$folder"/* ]] || kill_now $(processes_with "SLURM_CONF=$SLURM_CONF")
    wait
    if ((code == 0 || code == 77)); then rm -rf -- "$folder"; else printf 'logs: %s\n' "$folder"; fi
    exit "$code"
}

# --- What is tested

# Submits what follows; leaves its `said`, and the jobs `array` and `merge`.
submit() {
    said=$("$here/submit.sh" "$@" --stiction "$stiction") || return
    array=$(sed -n 's/^shards .* as job //p' <<<"$said")
    merge=$(sed -n 's/^merge  *job \([0-9]*\),.*/\1/p' <<<"$said")
}

state_of() { squeue --noheader --states=all --jobs="$1" --format=%T 2>/dev/null; }

# Whether a job has come to its end; $2: the end that it should come to.
has_ended() {
    local state
    state=$(state_of "$1")
    [[ $state == COMPLETED || $state == FAILED || $state == CANCELLED || $state == TIMEOUT || $state == NODE_FAIL ]]
}

completes() { wait_for "$2" has_ended "$1" && [[ $(state_of "$1") == COMPLETED ]]; }

same_bits() { "$python" "$root/tests/python/same_bits.py" "$@"; }

# Whether a folder holds so many files and folders, hidden ones included.
holds() { [[ $(find "$1" -mindepth 1 | wc -l) == "$2" ]]; }

logged() { grep -q -- "$2" "$1" 2>/dev/null; }

# Kills the program on a node as often as its task starts it.
fails_on() {
    holds_process_on "$1" || return 1
    local same=$shard log
    log=$(log_of "$2")
    until logged "$log" "ends with 137"; do
        if holds_process_on "$1"; then
            kill -CONT "$process"
            [[ $shard != "$same" ]] || kill_now "$process"
        fi
        ((SECONDS < deadline)) || return 1
        sleep 0.1
    done
}

# Holds one process on each of two nodes: `held`.
holds_two() {
    local node
    for node in 1 2 3 4; do
        [[ ! ${held[node]-} ]] && holds_process_on "$node" && held[node]=$process
    done
    ((${#held[@]} == 2))
}

log_of() { printf '%s/logs/shard-%s.log' "$1" "$(basename -- "$shard" .shard)"; }

# As many replicas as take a minute on one thread, on a machine of whatever speed.
choose_replicas() {
    local begin end
    begin=$(date +%s%N)
    "$stiction" run "$scene" --replicas 400 --threads 1 --quiet -o "$folder/speed.h5" >/dev/null
    end=$(date +%s%N)
    replicas=$((60 * 400 * 10 ** 9 / (end - begin) / 128 * 128))
}

compute_reference() { "$stiction" run "$scene" --replicas "$replicas" --quiet -o "$folder/reference.h5" >/dev/null; }

test_lost_nodes() {
    local output="$folder/an experiment" lost parted killed process shard
    local arguments=("$scene" --shards 16 --replicas "$replicas" --checkpoint 1 --output "$output" --time=10)
    check "submit.sh submits 16 shards and a merge" submit "${arguments[@]}"
    check "a task on node2 keeps a partial result" wait_for 60 holds_process_on 2
    lost=$(log_of "$output")
    kill_node 2
    check "a task on node3 keeps a partial result" wait_for 60 holds_process_on 3
    killed=$(log_of "$output")
    kill_now "$process"
    check "a task on node4 keeps a partial result" wait_for 60 holds_process_on 4
    parted=$(log_of "$output")
    # The node is lost to Slurm, and its task works on.
    kill_now "${slurmd[4]}"
    local works_on=$process
    check "a task on node1 fails, because its stiction is killed three times" wait_for 60 fails_on 1 "$output"
    local merge_before=$merge
    check "the same command again" submit "${arguments[@]}"
    check "... submits that shard alone" grep -q ", 1 submitted as job" <<<"$said"
    check "... and another merge for the one before" wait_for 20 is_gone "$merge_before"
    check "the killed stiction is started again in its task" wait_for 30 logged "$killed" "killed by signal 9: goes on"
    check "... and Slurm gives up node2 and node4" wait_for 60 nodes_are 'down\*' 2
    start_node 2
    check "node2 comes back" wait_for 60 node_answers 2
    check "the task of node2 is requeued" wait_for 120 logged "$lost" "restarted 1 times"
    check "... and resumes what it had kept" wait_for 10 logged "$lost" "goes on: [1-9][0-9]* of"
    check "the task of node4 is requeued, and waits for what works on there" wait_for 120 logged "$parted" "waits for the other"
    kill -CONT "$works_on"
    check "the merge ends well" completes "$merge" 240
    check "the merged file has the bits of a run on one machine" same_bits "$folder/reference.h5" "$output/case_ii.h5"
    check "the merge has validated it" logged "$output/logs/merge.log" "ensemble and integral agree"
    check "each of the 16 shards is there, and nothing else" holds "$output/shards" 16

    local before
    before=$(stat --format='%n %Y %i' "$output"/shards/*)
    check "the same command again" submit "${arguments[@]}"
    check "... submits the merge alone" test -z "$array"
    check "... which ends well" completes "$merge" 60
    check "... and leaves the shards alone" test "$before" == "$(stat --format='%n %Y %i' "$output"/shards/*)"
    check "... and the bits" same_bits "$folder/reference.h5" "$output/case_ii.h5"
    start_node 4
    check "node4 comes back" wait_for 60 nodes_are idle 4
}

# In the scratch folders of the nodes, so that a task finds only what was copied.
test_time_limit_and_cancel() {
    local output=$folder/limited process shard times
    local arguments=("$scene" --shards 2 --replicas "$replicas" --checkpoint 1 --output "$output" --scratch "$folder/scratch of a node")
    check "submit.sh submits 2 shards, of a minute at most" submit "${arguments[@]}" --time=1 --save-before 60
    local log=$output/logs/shard-1.log
    # Held, so that no machine is fast enough to be done before.
    held=()
    check "both tasks keep partial results" wait_for 60 holds_two
    check "a task saves before the time limit" wait_for 90 logged "$log" "the time limit is near: saves"
    check "... and so does the other" wait_for 10 logged "$output/logs/shard-2.log" "the time limit is near: saves"
    kill -CONT "${held[@]}"
    check "... and requeues itself" wait_for 30 logged "$log" "  requeues"
    check "... starts again" wait_for 90 logged "$log" "restarted 1 times"
    check "... and resumes" wait_for 10 logged "$log" "goes on: [1-9][0-9]* of"
    scancel "$array"
    check "scancel ends the tasks" wait_for 40 is_gone "$array"
    check "... and the merge with them" wait_for 40 is_gone "$merge"
    times=$(grep -c "  requeues" "$log")
    sleep 10
    check "... and neither comes back" test "$(squeue --noheader | wc -l)" == 0
    check "... nor was requeued by itself" test "$(grep -c "  requeues" "$log")" == "$times"
    check "a cancelled task has kept its partial result" test -s "$output/shards/1.shard.partial"
    check "... and left nothing in scratch" holds "$folder/scratch of a node" 0
    check "the same command with more time" submit "${arguments[@]}" --time=10
    check "... ends well" completes "$merge" 200
    check "... has resumed" test "$(grep -c "goes on: [1-9][0-9]* of" "$log")" -ge 2
    check "... and has the bits of a run on one machine" same_bits "$folder/reference.h5" "$output/case_ii.h5"
    check "... and left nothing but shards" holds "$output/shards" 2
}

is_gone() { [[ ! $(squeue --noheader --jobs="$1" 2>/dev/null) ]]; }

main() {
    folder=$(mktemp -d "${TMPDIR:-/tmp}/stiction-cluster.XXXXXX")
    trap clean_up EXIT
    trap 'exit 1' INT TERM HUP
    [[ -x $stiction ]] || { echo "no program $stiction: cargo build --release" && exit 1; }
    install_slurm
    find_python
    check "free ports" free_ports
    configure
    # What Slurm needs of a host is not what is tested here.
    start_cluster || skip "this host lets no cluster start: $(cat "$folder"/log/output "$folder"/log/slurmctld.log 2>/dev/null | grep -i error | tail -n 3)"
    check "a cluster of four nodes, $(sbatch --version)" nodes_are idle 4
    check "the speed of this machine is measured" choose_replicas
    check "a run of $replicas replicas on one machine" compute_reference
    test_lost_nodes
    test_time_limit_and_cancel
    echo "all held, in $SECONDS s"
}

main
