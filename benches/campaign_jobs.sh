#!/usr/bin/env bash
# Two local jobs against one: the campaign of 24 tables of tests/slurm, in pairs, with the ratio of the times of each.
# For a quiet machine of two cores or more: campaign_jobs.sh [ROUNDS]
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --locked --bin flangeway
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for round in $(seq "${1:-3}"); do
  for jobs in 1 2; do
    begin=$(date +%s.%N)
    target/release/flangeway campaign run tests/slurm/campaign.toml -o "$work/$round-$jobs" --jobs "$jobs" 2>"$work/log"
    eval "seconds$jobs=$(date +%s.%N)-$begin"
  done
  awk "BEGIN { one = $seconds1; two = $seconds2; printf \"one job %.1f s, two jobs %.1f s, ratio %.2f\n\", one, two, one / two }"
done
