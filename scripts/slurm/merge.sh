#!/usr/bin/env bash
# The job after the array of submit.sh: merges the shards, prints the summary, and validates the result.
set -euo pipefail
folder=$1 stiction=$2 result=$3 shards=$4
files=()
for ((index = 1; index <= shards; index++)); do
    files+=("$folder/shards/$(printf '%0*d.shard' "${#shards}" "$index")")
done
# Merged anew it has the same bits, so an earlier result is not worth a refusal.
"$stiction" merge -o "$result" --force --quiet --threads "${SLURM_CPUS_PER_TASK:-1}" "${files[@]}"
"$stiction" validate "$result"
