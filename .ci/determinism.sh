#!/usr/bin/env bash
# Runs two short studies on every platform and schedule that the determinism contract names, and compares the results
# digests. Catches whatever makes bits depend on the optimiser, debug checks, threads, order of trials, directory,
# locale, time zone, the CPU's instruction set or the architecture.
#
#   .ci/determinism.sh [PLATFORM...]      default: all of them, cheapest first
#
# `qemu64` needs qemu-x86_64 and `aarch64` needs qemu-aarch64 (Debian: qemu-user) and
# `rustup target add aarch64-unknown-linux-musl`; one whose tools are missing counts as failed, never as passed.
# Exit code 0 where all digests are equal, 1 where one differs or could not be had.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}
study=(manifests/quickstart.yaml manifests/deadline-calibration.yaml --trials 2)
all=(release jobs-1 jobs-2 shuffled elsewhere dev opt0 qemu64 aarch64)
[ $# -gt 0 ] || set -- "${all[@]}"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Prints one digest of the results of both studies; all further arguments are the command that runs the program.
digest() {
  "$@" "${study[@]}" --out "$work/out" --format json | sed -n 's/.*"results_digest":"sha256:\([^"]*\)".*/\1/p' |
    sha256sum | cut -d' ' -f1
}
keep() { # NAME FILE: binaries of several profiles land in one place, so each is copied away
  cp "$2" "$work/reenact-$1"
}
ensure_release() {
  [ -x "$work/reenact-release" ] || { cargo build --release --quiet && keep release "$target/release/reenact"; }
}

release() { ensure_release && digest "$work/reenact-release" run --no-cache; }
jobs-1() { ensure_release && digest "$work/reenact-release" run --no-cache --jobs 1; }
jobs-2() { ensure_release && digest "$work/reenact-release" run --no-cache --jobs 2; }
# The second condition first, then one trial of the first, then the whole study from what the store has and has not.
shuffled() {
  ensure_release
  local run=(env "REENACT_STORE=$work/store" "$work/reenact-release" run)
  "${run[@]}" "${study[0]}" --trials 2 --only prior=floor-plan --out "$work/parts" >"$work/log" || return 1
  "${run[@]}" "${study[0]}" --trials 1 --only prior=none --out "$work/parts" >>"$work/log" || return 1
  digest "${run[@]}"
}
# Another directory and other ways to write numbers, letters and hours.
elsewhere() {
  ensure_release
  mkdir -p "$work/başka yer"
  cp -r manifests robots worlds "$work/başka yer/"
  (cd "$work/başka yer" &&
    LC_ALL=tr_TR.UTF-8 LANG=tr_TR.UTF-8 TZ=Asia/Kathmandu digest "$work/reenact-release" run --no-cache)
}
# Built as a side effect of a test, whose dependencies are those that `cargo test` has built already; `cargo build` would
# select other features and build them again.
build_dev() { cargo test --quiet --no-run --test integration; }
# Optimised a little, with debug assertions and overflow checks.
dev() {
  build_dev && keep dev "$target/debug/reenact" && digest "$work/reenact-dev" run --no-cache
}
# Our code not optimised at all. The dependencies keep the dev profile's optimisation, so they are not built again.
opt0() {
  CARGO_PROFILE_DEV_OPT_LEVEL=0 build_dev && keep opt0 "$target/debug/reenact" &&
    digest "$work/reenact-opt0" run --no-cache
}
# An x86-64 CPU of 2003: no FMA, AVX or SSE4.
qemu64() { ensure_release && digest qemu-x86_64 -cpu qemu64 "$work/reenact-release" run --no-cache; }
# Another architecture and another C library, linked without a cross compiler.
aarch64() {
  CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER=rust-lld cargo build --release --quiet --target aarch64-unknown-linux-musl &&
    digest qemu-aarch64 "$target/aarch64-unknown-linux-musl/release/reenact" run --no-cache
}

expected=
failed=0
for platform in "$@"; do
  case " ${all[*]} " in *" $platform "*) ;; *) echo "no platform \`$platform\`: one of ${all[*]}" >&2 && exit 2 ;; esac
  began=$SECONDS
  found=$("$platform" 2>"$work/errors") || found=
  : "${expected:=$found}"
  word=same
  if [ -z "$found" ]; then
    word=FAILED failed=1
    sed 's/^/    /' "$work/errors" >&2
  elif [ "$found" != "$expected" ]; then
    word=DIFFERENT failed=1
  fi
  printf '%-10s %-72s %5d s  %s\n' "$platform" "${found:-none}" $((SECONDS - began)) "$word"
done
exit $failed
