# Sourced by whatever builds for others, in the root of the checkout: where files lay here is nobody's business, and would make the
# same source differ from folder to folder. Sets CARGO_ENCODED_RUSTFLAGS, for folders may have blanks in their names.
CARGO_ENCODED_RUSTFLAGS=$(printf -- '--remap-path-prefix=%s\x1f' \
  "$PWD=/reenact" "${CARGO_HOME:-$HOME/.cargo}=/cargo" "$(rustc --print sysroot)=/rust")
export CARGO_ENCODED_RUSTFLAGS=${CARGO_ENCODED_RUSTFLAGS%$'\x1f'}
unset RUSTFLAGS
