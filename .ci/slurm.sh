#!/usr/bin/env bash
# Runs the quickstart on a real Slurm of one machine and two nodes: `reenact submit`, a node killed in the middle of a shard, the
# task queued again, the sealing job after it; the bundle must have the results of a single run.
#
#   .ci/slurm.sh REENACT [--keep FOLDER]      FOLDER: where logs and Slurm's configuration stay
#
# Needs slurmctld, slurmd, slurm-client, slurm-wlm-basic-plugins and munge: installed, or unpacked without root below `SLURM_ROOT`
# (`apt-get download ...; dpkg -x PACKAGE.deb $SLURM_ROOT`, links without `-wlm` to its programs, and their libraries in LD_LIBRARY_PATH). The system's own configuration is
# neither read nor written. Exit code 77 where Slurm is not to be had.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: $0 REENACT [--keep FOLDER]" >&2; exit 2; }
reenact=$(realpath "$1")
root=${SLURM_ROOT:-}
export PATH=$root/usr/bin:$root/usr/sbin:$PATH
for program in slurmctld slurmd sbatch scontrol squeue munged; do
  command -v "$program" >/dev/null || {
    echo "SKIP  Slurm: no $program (Debian: slurmctld slurmd slurm-client slurm-wlm-basic-plugins munge)" >&2
    exit 77
  }
done

# Short, and for others to enter: the path of a socket has at most 107 bytes, and munge looks at who may write above it.
work=$(mktemp -d /tmp/slurm.XXXXXX)
chmod 755 "$work"
began=()
# Whatever was begun here, and nothing else.
finish() {
  local code=$? pid
  for pid in "${began[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
  if [ "$code" -ne 0 ]; then tail -n 20 "$work"/*.log "$work"/study/*.slurm/*.log 2>/dev/null || true; fi
  if [ -n "${keep:-}" ]; then mkdir -p "$keep" && cp -r "$work"/*.log "$work"/*.conf "$work"/study/*.slurm "$work"/study/.snakemake/slurm_logs "$keep" 2>/dev/null || true; fi
  rm -rf "$work"
}
trap finish EXIT
[ "${2:-}" != --keep ] || keep=$3
user=$(id -un) host=$(hostname -s)
said() { echo "$(date +%H:%M:%S)  $*"; }
fail() { echo "FAIL  $*" >&2 && exit 1; }

# A key and a socket of its own.
mkdir -m 700 "$work/munge"
head -c 1024 /dev/urandom >"$work/munge/munge.key"
chmod 600 "$work/munge/munge.key"
# Others must reach the socket, and munged looks at its folder.
mkdir -m 755 "$work/socket"
munged --foreground --force --key-file "$work/munge/munge.key" --socket "$work/socket/munge.sock" --pid-file "$work/munge/munged.pid" \
  --seed-file "$work/munge/munged.seed" --log-file "$work/munged.log" >/dev/null 2>&1 &
began+=($!)
disown

# Ports that nobody uses, as likely as not.
port=$((20000 + RANDOM % 20000))
mkdir "$work/state" "$work/spool-a" "$work/spool-b"
plugins=$(dirname "$(find "$root/usr/lib" -name cred_munge.so 2>/dev/null | head -n 1)")
cat >"$work/slurm.conf" <<CONF
ClusterName=reenact
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
SlurmctldPort=$port
AuthType=auth/munge
AuthInfo=socket=$work/socket/munge.sock
CredType=cred/munge
PluginDir=$plugins
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=10
MinJobAge=3600
SchedulerParameters=bf_interval=1,sched_interval=2
NodeName=a NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=2000 State=UNKNOWN
NodeName=b NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=2000 State=UNKNOWN
PartitionName=lab Nodes=a,b Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
for _ in $(seq 50); do [ ! -S "$work/socket/munge.sock" ] || break; sleep 0.1; done
slurmctld -D >"$work/slurmctld.out.log" 2>&1 &
began+=($!)
disown
# A node: `node NAME` begins one, whose number `nodes` keeps.
declare -A nodes
node() {
  slurmd -D -N "$1" >>"$work/slurmd-$1.out.log" 2>&1 &
  nodes[$1]=$!
  began+=($!)
  disown
}
node a
node b
until_true() { # SECONDS WHAT COMMAND...
  local seconds=$1 what=$2 end=$((SECONDS + $1))
  shift 2
  until "$@"; do
    [ $SECONDS -lt $end ] || fail "after $seconds s: $what"
    sleep 0.3
  done
}
both_idle() { [ "$(sinfo -h -o %T -N 2>/dev/null | grep -c idle)" -eq 2 ]; }
until_true 60 "two idle nodes, found: $(sinfo 2>&1 || true)" both_idle
said "Slurm $(slurmctld -V | cut -d' ' -f2), nodes: $(sinfo -h -N -o '%N %T' | tr '\n' ';')"

# A study of its own folder; the trials are those of the quickstart, eight times as many (TRIALS=80 for each condition), so that a shard lasts.
mkdir "$work/study"
cp -r manifests robots worlds "$work/study"
cd "$work/study"
trials=${TRIALS:-80}
export REENACT_STORE=$work/study/store
"$reenact" run manifests/quickstart.yaml --trials "$trials" --no-cache --out single --format json >single.json
results() { sed -n 's/.*"results_digest":"\([^"]*\)".*/\1/p' "$1"; }
said "single run    $(results single.json)"

"$reenact" submit manifests/quickstart.yaml --engine slurm --shards 4 --trials "$trials" --partition lab --format json >submitted.json
array=$(sed -n 's/.*"array_job":"\([0-9]*\)".*/\1/p' submitted.json) seal=$(sed -n 's/.*"seal_job":"\([0-9]*\)".*/\1/p' submitted.json)
said "submitted: array $array of 4 shards, sealing job $seal ($(squeue -h -j "$seal" -o '%T, %r'))"

records() { cat "$REENACT_STORE"/segments/*.jsonl 2>/dev/null | wc -l; }
on_b() { squeue -h -w b -t RUNNING -o %i | head -n 1; }
begun() { [ -n "$(on_b)" ] && [ "$(records)" -ge 3 ]; }
until_true 60 "a shard at work on node b" begun
task=$(on_b) before=$(records)
said "node b runs $task; $before records are in the store: the node is killed"
# The daemon with everything below it, as when a machine goes.
below() { for child in $(pgrep -P "$1"); do below "$child" && echo "$child"; done; }
kill -9 "${nodes[b]}" $(below "${nodes[b]}")
scontrol update NodeName=b State=DOWN Reason="killed by the test"
requeued() { scontrol show job "$task" | grep -q "Requeue=1 Restarts=[1-9]"; }
until_true 60 "$task queued again" requeued
said "$task: $(scontrol show job "$task" | grep -o 'JobState=[A-Z]* Reason=[A-Za-z]*\|Restarts=[0-9]*' | tr '\n' ' ')"
sleep 2
node b
scontrol update NodeName=b State=RESUME 2>/dev/null || true
ended() { ! squeue -h -j "$array,$seal" -t PENDING,RUNNING,COMPLETING,CONFIGURING 2>/dev/null | grep -q .; }
until_true 300 "all jobs at an end, found: $(squeue)" ended
squeue -h -t all -o '%i %j %T' | sort
for job in $(squeue -h -t all -r -j "$array,$seal" -o %i); do
  scontrol show job "$job" | grep -q JobState=COMPLETED || fail "job $job: $(scontrol show job "$job" | grep JobState)"
done
cat quickstart.slurm/shard-*.log | grep " of quickstart: " || true
grep -A1 "from the store\|^results" quickstart.slurm/seal-*.log
grep -q "; 0 simulated in" quickstart.slurm/seal-*.log || fail "the sealing job simulated trials again"
digest=$(sed -n 's/^results //p' quickstart.slurm/seal-*.log)
said "by Slurm      $digest"
[ "$digest" = "$(results single.json)" ] || fail "other results than a single run's"
"$reenact" verify artifacts/*.zip | tail -n 1
"$reenact" cache size
# The same study by Snakemake's executor for Slurm, where `SNAKEMAKE` says where that is.
if [ -n "${SNAKEMAKE:-}" ]; then
  # It hides Slurm's variables from its jobs, and so where this Slurm's configuration is.
  mkdir "$work/bin"
  printf '#!/bin/sh\nSLURM_CONF=%s exec %s "$@"\n' "$SLURM_CONF" "$(command -v srun)" >"$work/bin/srun"
  chmod +x "$work/bin/srun"
  export PATH=$work/bin:$PATH
  # Without Slurm's accounting, which this one has not, the executor asks squeue.
  "$SNAKEMAKE" --snakefile "$OLDPWD/examples/snakemake/Snakefile" --executor slurm --jobs 4 --latency-wait 30 \
    --slurm-status-command squeue --slurm-init-seconds-before-status-checks 5 --seconds-between-status-checks 5 \
    --default-resources slurm_partition=lab slurm_account=lab mem_mb=100 runtime=10 \
    --config reenact="$reenact" options="--no-cache" >"$work/snakemake.log" 2>&1 || fail "Snakemake: $(tail -n 30 "$work/snakemake.log")"
  by_snakemake=$("$reenact" verify quickstart.zip | sed -n 's/^results  *//p')
  said "by Snakemake on Slurm  ${by_snakemake:-none}"
  "$reenact" run manifests/quickstart.yaml --no-cache --out quickstart --format json >quickstart.json
  [ "$by_snakemake" = "$(results quickstart.json)" ] || fail "other results than a single run's: $(results quickstart.json)"
fi
said "the node killed, one task queued again, and the results of a single run"
