#!/usr/bin/env bash
# A campaign on a Slurm cluster of two nodes on this one machine: one node and one task are killed midway, the campaign
# is resumed, and every table is compared byte for byte with a local run. Then a part of it by Snakemake.
# Needs root (for munge and Slurm's daemons) and Debian's packages, which it installs. Fails on any failure.
set -euo pipefail
cd "$(dirname "$0")/../.."
here=$PWD
scratch=$(mktemp -d /tmp/flangeway-slurm.XXXXXX)
conf=$scratch/slurm.conf
began=$SECONDS

# Processes of ours whose environment has all these lines: the cluster's daemons, their steps, the tasks.
ours() {
  local files line
  files=$(grep -lzxF -- "SLURM_CONF=$conf" /proc/[0-9]*/environ 2>/dev/null || true)
  for line in "$@"; do
    # shellcheck disable=SC2086
    files=$(grep -lzxF -- "$line" /dev/null $files 2>/dev/null || true)
  done
  tr -dc '0-9\n' <<<"$files"
}
end() {
  local status=$?
  trap - EXIT
  if [ "$status" != 0 ]; then
    echo "failed; the cluster's last words:" >&2
    tail -n 15 "$scratch"/*.log "$scratch"/cluster/slurm/*.log >&2 2>/dev/null || true
  fi
  # shellcheck disable=SC2046
  kill -9 $(ours) ${munged:-} 2>/dev/null || true
  wait 2>/dev/null || true
  umount "$scratch/small" 2>/dev/null || true
  rm -rf "$scratch"
  exit "$status"
}
trap end EXIT
trap 'exit 130' INT TERM

# poll SECONDS WHAT COMMAND...: until the command succeeds.
poll() {
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@"; do
    if [ "$SECONDS" -ge "$deadline" ]; then
      echo "waited too long for $what" >&2
      exit 1
    fi
    sleep 0.3
  done
}
say() { printf '[%3d s] %s\n' $((SECONDS - began)) "$*"; }

if ! command -v slurmctld >/dev/null || ! command -v slurmd >/dev/null || ! command -v munged >/dev/null; then
  say "installing slurm-wlm and munge"
  export DEBIAN_FRONTEND=noninteractive
  { apt-get update && apt-get install -y --no-install-recommends slurm-wlm munge; } >"$scratch/apt.log" 2>&1
fi
cargo build --release --locked --bin flangeway
flangeway=$here/target/release/flangeway

# --- the cluster
chmod 755 "$scratch"
mkdir -m 700 "$scratch/munge"
head -c 1024 /dev/urandom >"$scratch/munge/key"
chmod 600 "$scratch/munge/key"
munged --foreground --force --key-file="$scratch/munge/key" --socket="$scratch/munge.socket" \
  --pid-file="$scratch/munge/pid" --log-file="$scratch/munge/log" --seed-file="$scratch/munge/seed" \
  >"$scratch/munged.log" 2>&1 &
munged=$!
# Ports of this run's own, below those that the system gives out.
port=$((20000 + $$ % 4000 * 3))
cat >"$conf" <<EOF
ClusterName=flangeway
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$scratch/munge.socket
CredType=cred/munge
SlurmctldPort=$port
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd-%n.pid
SlurmdSpoolDir=$scratch/spool-%n
StateSaveLocation=$scratch/state
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/slurmd-%n.log
SlurmctldParameters=node_reg_mem_percent=1
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1,batch_sched_delay=0
ReturnToService=2
SlurmdTimeout=6
SlurmctldTimeout=30
InactiveLimit=0
KillWait=5
MessageTimeout=10
MaxArraySize=5
MpiDefault=none
NodeName=n0 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=1000
NodeName=n1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=1000
PartitionName=all Nodes=n0,n1 Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF=$conf
mkdir "$scratch/state"
node() { THIS_NODE=$1 slurmd -D -N "$1" -f "$conf" >"$scratch/slurmd-$1.out" 2>&1 & }
poll 30 "munge" test -S "$scratch/munge.socket"
slurmctld -D -c -f "$conf" >"$scratch/slurmctld.out" 2>&1 &
node n0
node n1
both_idle() { [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | sort -u | tr '\n' ' ')" = "n0 n1 " ]; }
poll 60 "both nodes" both_idle
say "nodes: $(sinfo -h -N -o '%N (%t, %c core)' | tr '\n' ' ')"

# --- the campaign, and what happens to it
cluster=$scratch/cluster
"$flangeway" campaign slurm tests/slurm/campaign.toml -o "$cluster" >"$scratch/jobs"
[ "$(wc -l <"$scratch/jobs")" -gt 1 ] # two arrays, as the cluster allows none of eight tasks
say "submitted as arrays $(tr '\n' ' ' <"$scratch/jobs")(MaxArraySize 5)"
tables() { find "$1/tables" -name '*.fwt' | wc -l; }
running_on() { squeue -h -t R -w "$1" -o %i 2>/dev/null; }
midway() { [ "$(tables "$cluster")" -ge 4 ] && [ -n "$(running_on n0)" ] && [ -n "$(running_on n1)" ] && [ -n "$(task_pids n0)" ]; }
# The program of a task, not the shell it was started by.
task_pids() {
  local pid
  for pid in $(ours "SLURMD_NODENAME=$1"); do
    if [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = flangeway ]; then echo "$pid"; fi
  done
}
poll 120 "the first tables and a task on each node" midway
on_n1=$(running_on n1)
say "killing node n1 with task $on_n1 on it, $(tables "$cluster") tables there"
# As if its power had gone: the daemon, its steps (parents of what runs), what runs.
tasks_on_n1=$(ours SLURMD_NODENAME=n1)
steps_on_n1=$(for pid in $tasks_on_n1; do ps -o ppid= -p "$pid"; done | sort -u |
  while read -r pid; do [ "$(cat "/proc/$pid/comm")" != slurmstepd ] || echo "$pid"; done)
# shellcheck disable=SC2046,SC2086
kill -9 $(ours THIS_NODE=n1) $steps_on_n1 $tasks_on_n1 2>/dev/null || true
killed_one() {
  victim=$(running_on n0) && pid=$(task_pids n0 | head -n 1) && [ -n "$victim" ] && [ -n "$pid" ] && kill -9 "$pid"
}
poll 60 "a task to kill" killed_one
say "killed task $victim (process $pid on n0)"
# Meanwhile the same campaign without a cluster, to compare with.
local=$scratch/local
"$flangeway" campaign run tests/slurm/campaign.toml -o "$local" --jobs 1 2>"$scratch/local.log" &
local_run=$!
requeued() { grep -hoE 'requeue job JobId=[0-9]+_[0-9]+\([0-9]+\)|[Rr]equeuing? JobId=[0-9]+_[0-9]+\([0-9]+\)' "$scratch/slurmctld.log" | grep -oE '[0-9]+_[0-9]+' | sort -u; }
n1_down() { [ -n "$(sinfo -h -N -n n1 -t down -o %N)" ]; }
poll 60 "the controller to see n1 down" n1_down
poll 20 "the requeueing of n1's task" requeued >/dev/null
say "n1 is down; requeued: $(requeued | tr '\n' ' ')"
# Slurm lets a requeued task wait two minutes; here that would only be waited for.
for task in $(requeued); do scontrol update "JobId=$task" StartTime=now || true; done
node n1
say "n1 is started again"
queue_empty() { [ -z "$(squeue -h -o %i)" ]; }
poll 300 "the queue to empty" queue_empty
damaged=$(find "$cluster/tables" -name '*.fwt' | sort | head -n 1)
truncate -s -64 "$damaged"
if "$flangeway" campaign status "$cluster" 2>"$scratch/status"; then
  echo "the killed task has lost nothing: the test tests nothing" >&2
  exit 1
fi
say "status before resuming (one table cut short by hand): $(head -n 1 "$scratch/status")"
grep -q ' 0 missing' "$scratch/status" && { echo "nothing is missing although a task was killed" >&2; exit 1; }

poll 60 "n1 to come back" both_idle
"$flangeway" campaign resume "$cluster" --slurm >"$scratch/jobs"
say "resumed as $(tr '\n' ' ' <"$scratch/jobs")on n0 and n1"
poll 240 "the queue to empty" queue_empty
"$flangeway" campaign status "$cluster"
compiled() { cat "$cluster"/records/*.jsonl | grep -c '"finish":"done"'; }
say "$(compiled) compilations for $(tables "$cluster") tables; by node: $(cat "$cluster"/records/*.jsonl |
  grep -o '"host":"[^"]*"' | sort | uniq -c | tr -s ' \n' ' ')"

# --- byte for byte
wait "$local_run" || { cat "$scratch/local.log"; exit 1; }
equal=0
for table in "$local"/tables/*.fwt; do
  cmp "$table" "$cluster/tables/$(basename "$table")"
  equal=$((equal + 1))
done
[ "$equal" -ge 24 ] && [ "$equal" = "$(tables "$cluster")" ]
[ -z "$(find "$cluster/tables" -name '.flangeway-*')" ] || say "left over: $(find "$cluster/tables" -name '.flangeway-*' | wc -l) temporary files"
total=$equal
say "$total tables equal, byte for byte, cluster and local"
"$flangeway" campaign report "$cluster"

# --- a full disk, on a part of the same campaign
part=$scratch/part.toml
sed 's/"cone:1\/20", "cone:1\/40"/"cone:1\/20"/; s/\["60e1", "54e1"\]/"60e1"/; s/\["s1002", /[/' tests/slurm/campaign.toml >"$part"
mkdir "$scratch/small"
if mount -t tmpfs -o size=148k tmpfs "$scratch/small" 2>/dev/null; then
  status=0
  "$flangeway" campaign run "$part" -o "$scratch/small/out" --jobs 1 2>"$scratch/full.log" || status=$?
  [ "$status" = 2 ] && grep -q 'No space left' "$scratch/full.log" || { cat "$scratch/full.log" >&2; exit 1; }
  full=$(tables "$scratch/small/out")
  [ -z "$(find "$scratch/small" -name '.flangeway-*')" ]
  mount -o remount,size=8m "$scratch/small"
  "$flangeway" campaign resume "$scratch/small/out" 2>"$scratch/full.log"
  for table in "$scratch"/small/out/tables/*.fwt; do cmp "$table" "$local/tables/$(basename "$table")"; done
  say "a full disk stopped a run after $full tables; resumed to $(tables "$scratch/small/out"), all equal"
  umount "$scratch/small"
else
  say "note: no file system can be mounted here; the full disk was not tried"
fi

# --- Snakemake, on a part of the same campaign
if python3 -m venv "$scratch/venv" >/dev/null 2>&1 &&
  "$scratch/venv/bin/pip" install --quiet --disable-pip-version-check 'snakemake>=8' >"$scratch/pip.log" 2>&1; then
  mkdir "$scratch/snakemake"
  cp "$part" "$scratch/snakemake/campaign.toml"
  (cd "$scratch/snakemake" && PATH=$here/target/release:$PATH "$scratch/venv/bin/snakemake" --cores 2 --quiet all \
    --snakefile "$here/examples/snakemake/Snakefile" --config campaign=campaign.toml folder=out) \
    >"$scratch/snakemake.log" 2>&1 || { cat "$scratch/snakemake.log" >&2; exit 1; }
  equal=0
  for table in "$scratch"/snakemake/out/tables/*.fwt; do
    cmp "$table" "$local/tables/$(basename "$table")"
    equal=$((equal + 1))
  done
  [ "$equal" -ge 4 ]
  say "$equal tables by Snakemake, equal too"
else
  say "note: Snakemake cannot be installed here; its example was not run"
fi
say "passed: nodes n0 and n1; killed node n1 and task $victim; requeued $(requeued | tr '\n' ' '); $total tables equal"
