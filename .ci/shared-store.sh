#!/usr/bin/env bash
# Eight processes on one store, killed at random moments and begun again, while others put its files together and look at it: no
# finished trial may be lost or changed, and whoever seals has the results of an undisturbed run.
#
#   .ci/shared-store.sh REENACT [KILLS] [SEED]      default: 100 kills, a seed of its own, which is printed
#
# Rounds: eight shards of a study of forty short trials run as workers on an empty store (`--no-seal`); whichever is killed is begun
# again. When all have ended, a plain run seals. Exit code 0 where all went well.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: $0 REENACT [KILLS] [SEED]" >&2; exit 2; }
reenact=$1 kills=${2:-100} seed=${3:-$(od -An -N2 -tu2 /dev/urandom | tr -d ' ')}
RANDOM=$seed
study=(run manifests/quickstart.yaml --trials 20 --set parameters.mission.time-limit-s=8 --jobs 1 --format json)

# Without the shell's own notes about processes that were killed.
exec 2> >(grep -v " Killed " >&2 || true)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
killed=0
fail() { echo "kill $killed, seed $seed: $*" >&2 && exit 1; }
results_of() { sed -n 's/.*"results_digest":"\([^"]*\)".*/\1/p' "$1"; }
# Every whole record, whichever file it is in.
records() {
  { cat "$1"/segments/*.jsonl 2>/dev/null || true; } | { grep -aE '^\{"key":"[0-9a-f]{64}","sha256":.*\}\}$' || true; } | LC_ALL=C sort -u
}
"$reenact" "${study[@]}" --no-cache --out "$work/undisturbed" >"$work/undisturbed.json"
expected=$(results_of "$work/undisturbed.json")
echo "undisturbed: $expected (seed $seed)"

rounds=0 tidied=0
while [ "$killed" -lt "$kills" ]; do
  export REENACT_STORE=$work/store-$rounds
  mkdir "$REENACT_STORE"
  : >"$work/before"
  declare -A workers=()
  begin() {
    "$reenact" "${study[@]}" --no-seal --shard "$1/8" >"$work/worker-$1.json" 2>"$work/worker-$1.txt" &
    workers[$1]=$!
  }
  for shard in 1 2 3 4 5 6 7 8; do begin "$shard"; done
  left=8
  while [ "$left" -gt 0 ]; do
    sleep "0.$(printf %03d $((RANDOM % 120)))"
    victim=$((RANDOM % 8 + 1))
    if [ "$killed" -lt "$kills" ] && [ -n "${workers[$victim]:-}" ] && kill -9 "${workers[$victim]}" 2>/dev/null; then
      killed=$((killed + 1))
    fi
    # One in four times somebody tidies up meanwhile, or looks whether all is well.
    case $((RANDOM % 8)) in
      0) "$reenact" cache gc >/dev/null 2>&1 || fail "gc: $("$reenact" cache gc 2>&1)" && tidied=$((tidied + 1)) ;;
      1) "$reenact" cache verify --format json >"$work/verify.json" || true
         # A line that a killed process left has no end; nothing else may be wrong.
         ! grep -q '"found":"\(a record of\|another record\|the record of\)' "$work/verify.json" || fail "$(cat "$work/verify.json")" ;;
    esac
    records "$REENACT_STORE" >"$work/after"
    [ -z "$(LC_ALL=C comm -23 "$work/before" "$work/after")" ] || fail "a finished trial was lost or changed"
    mv "$work/after" "$work/before"
    for shard in "${!workers[@]}"; do
      pid=${workers[$shard]}
      kill -0 "$pid" 2>/dev/null && continue
      code=0
      wait "$pid" 2>/dev/null || code=$?
      case $code in
        0) unset "workers[$shard]"; left=$((left - 1)) ;;
        137) begin "$shard" ;;
        *) fail "shard $shard ended with $code: $(cat "$work/worker-$shard.txt")" ;;
      esac
    done
  done
  "$reenact" cache gc >"$work/gc.txt"
  "$reenact" cache verify >"$work/verify.txt" || fail "$(cat "$work/verify.txt")"
  "$reenact" "${study[@]}" --out "$work/out" >"$work/run.json"
  grep -q '"cached":40,' "$work/run.json" || fail "trials were simulated again: $(cat "$work/run.json")"
  [ "$(results_of "$work/run.json")" = "$expected" ] || fail "sealed other results: $(cat "$work/run.json")"
  rounds=$((rounds + 1))
done
echo "$killed kills of eight processes on one store in $rounds rounds, tidied up $tidied times meanwhile; every round sealed the undisturbed results"
