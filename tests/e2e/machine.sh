# What the scripts expect of the machine; to be sourced.

# Makes sure that there is a command, from the Debian packages named after it.
needs() {
  local command=$1
  shift
  if command -v "$command" >/dev/null; then
    return
  fi
  local root=()
  if [ "$(id -u)" -ne 0 ]; then
    root=(sudo -n)
  fi
  if ! command -v apt-get >/dev/null || ! "${root[@]}" true 2>/dev/null; then
    echo "$command is missing; install it (on Debian: apt-get install $*) and run this again" >&2
    exit 1
  fi
  printf '\n== %s s: apt-get install %s\n' "$SECONDS" "$*"
  "${root[@]}" apt-get update -q
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@"
}

# Rust is the one thing that has to be there.
needs_rust() {
  if ! command -v cargo >/dev/null && [ -f "${CARGO_HOME:-$HOME/.cargo}/env" ]; then
    . "${CARGO_HOME:-$HOME/.cargo}/env"
  fi
  if ! command -v cargo >/dev/null; then
    echo "cargo is missing; install Rust 1.95 or later from https://rustup.rs and run this again" >&2
    exit 1
  fi
  needs cc gcc libc6-dev
  needs make make
}
