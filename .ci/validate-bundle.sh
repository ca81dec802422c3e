#!/usr/bin/env bash
# Holds a bundle against three validators that are not ours: bagit.py, sha256sum and roc-validator (RO-Crate 1.1,
# Workflow RO-Crate 1.0, Process, Workflow and Provenance Run Crate 0.5, REQUIRED and RECOMMENDED; of crates in the words of
# RO-Crate 1.3, that at REQUIRED, since it knows no profiles for it yet).
#
#   .ci/validate-bundle.sh BUNDLE.zip|DIRECTORY...
#
# Needs python3 (3.10 or newer, with venv) and, the first time, PyPI; what it installs stays under target/validators.
# Exit code 0 where every bundle passes, 1 where one does not, 2 where the validators could not be had.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 1 ] || { echo "usage: $0 BUNDLE.zip|DIRECTORY..." >&2; exit 2; }

tools=${VALIDATORS:-$(dirname "$here")/target/validators}
bin=$tools/venv/bin
cache=$tools/roc_cache
pins=("$here/requirements-validate.txt" "$here/seed_roc_cache.py")
setup() {
  mkdir -p "$tools"
  python3 -m venv --clear "$tools/venv"
  "$bin/pip" install --quiet --disable-pip-version-check -r "$here/requirements-validate.txt"
  "$bin/pip" download --quiet --disable-pip-version-check --no-deps -d "$tools" rocrate==0.13.0
  rm -f "$cache.sqlite"
  "$bin/pip" download --quiet --disable-pip-version-check --no-deps -d "$tools" rocrate==0.16.0
  "$bin/python" "$here/seed_roc_cache.py" "$cache" "$tools"/rocrate-0.13.0-*.whl "$tools"/rocrate-0.16.0-*.whl
  cat "${pins[@]}" >"$tools/installed.txt"
}
# Installed again whenever the pins or the contexts change.
cat "${pins[@]}" | cmp -s - "$tools/installed.txt" || (setup) || { echo "could not install the validators" >&2; exit 2; }

source "$here/steps.sh"
sums() { (cd "$1" && sha256sum --quiet --check manifest-sha256.txt tagmanifest-sha256.txt); }
# roc-validator is pointed at data/ rather than at the bag, whose paths it would resolve against the wrong folder.
# 5.1 of the Process Run Crate profile wants every workflow to have an absolute identifier; Workflow RO-Crate wants the main
# workflow to be a file in the crate, which is relative. No crate can meet both (docs/bundle-format.md).
is_newer() { grep -q '"https://w3id.org/ro/crate/1.3/context"' "$1/data/ro-crate-metadata.json"; }
roc_newer() { # DIRECTORY
  "$bin/rocrate-validator" -y --disable-color validate --offline --cache-path "$cache" --no-paging -v \
    --profile-identifier ro-crate-1.3 --requirement-severity required "$1/data"
}
roc() { # LEVEL DIRECTORY
  "$bin/rocrate-validator" -y --disable-color validate --offline --cache-path "$cache" --no-paging -v \
    --profile-identifier provenance-run-crate-0.5 --requirement-severity "$1" --skip-checks process-run-crate-0.5_5.1 "$2/data"
}

for bundle in "$@"; do
  echo "$bundle"
  bag=$bundle
  if [ ! -d "$bundle" ]; then
    bag=$work/bag
    rm -rf "$bag" "$work/crate"
    "$bin/python" -m zipfile -e "$bundle" "$bag"
    if [ -f "$bag/ro-crate-metadata.json" ]; then
      mkdir "$work/crate" && mv "$bag" "$work/crate/data" && bag=$work/crate
    elif [ ! -f "$bag/bagit.txt" ]; then
      bag=$(dirname "$bag"/*/bagit.txt)
    fi
  fi
  # The bare crate, which is an RO-Crate without its bag, has the crate's checks only.
  if [ -f "$bag/bagit.txt" ]; then
    step "BagIt, bagit.py" "$bin/bagit.py" --quiet --validate "$bag"
    step "BagIt, sha256sum" sums "$bag"
  fi
  if is_newer "$bag"; then
    step "RO-Crate 1.3, REQUIRED" roc_newer "$bag"
    continue
  fi
  # The most specific profile holds every check of those it builds on.
  step "RO-Crate and Run Crate profiles, REQUIRED" roc required "$bag"
  step "RO-Crate and Run Crate profiles, RECOMMENDED" roc recommended "$bag"
done
exit $failed
