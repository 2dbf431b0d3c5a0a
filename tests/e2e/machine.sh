# What the scripts expect of the machine; to be sourced.

# Makes sure that there is a command, from the Debian packages named after it.
needs() {
  local command=$1
  shift
  if ! command -v "$command" >/dev/null; then
    installs "$command" "$@"
  fi
}

# Installs Debian packages, where that is possible.
installs() {
  local command=$1
  shift
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

# Installs the npm packages that the tests need into a folder, at the versions and with the hashes of the lock file.
# Once they are there, that needs no network.
needs_npm_packages() {
  local out=$1
  needs node nodejs
  needs npm npm
  mkdir -p "$out"
  cp tests/e2e/package.json tests/e2e/package-lock.json "$out/"
  if ! cmp -s tests/e2e/package-lock.json "$out/node_modules/installed.json"; then
    npm ci --prefix "$out" --ignore-scripts --no-audit --no-fund --loglevel=error --prefer-offline
    cp tests/e2e/package-lock.json "$out/node_modules/installed.json"
  fi
}

# Installs the Python packages that the tests need into an environment of their own, at the versions of
# tests/e2e/requirements.txt or of another list.
needs_python_packages() {
  local out=$1 list=${2:-tests/e2e/requirements.txt}
  needs python3 python3
  if ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
    installs "venv of python3" python3-venv
  fi
  if ! cmp -s "$list" "$out/installed.txt"; then
    python3 -m venv --clear "$out"
    "$out/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps -r "$list"
    cp "$list" "$out/installed.txt"
  fi
}
