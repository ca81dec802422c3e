# Sourced by checks of many steps: `step` runs each and goes on, `$failed` says at the end whether one did not hold, and
# `$work` is a folder that goes when the check ends.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
step() { # NAME COMMAND...
  local name=$1
  shift
  if "$@" >"$work/log" 2>&1; then
    echo "pass  $name"
  else
    echo "FAIL  $name"
    sed 's/^/      /' "$work/log" | tail -n 40
    failed=1
  fi
}
