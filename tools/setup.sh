# SPDX-License-Identifier: Apache-2.0
# Sourced by ./run and ./test: installs missing packages, configures and builds. Quick when there is nothing to do.
# shellcheck shell=bash

say() { printf '%s\n' "$*" >&2; }

# Packages of packages.txt that are not installed.
missing_packages() {
  local wanted have
  wanted=$(sed 's/#.*//' packages.txt | tr -s ' \n' '\n' | grep . | sort)
  have=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' 2>/dev/null | awk '$2 == "installed" {print $1}' | sort -u)
  comm -23 <(printf '%s\n' "$wanted") <(printf '%s\n' "$have")
}

install_packages() {
  # A stamp makes the common case (nothing to do) free of the package manager.
  local stamp="$build/packages.ok"
  if [ -f "$stamp" ] && [ "$stamp" -nt packages.txt ]; then return; fi
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    if command -v cmake >/dev/null && command -v ninja >/dev/null && [ -n "${SG_NO_INSTALL:-}" ]; then return; fi
    say "This system has no apt-get. Install what corresponds to these Debian packages, then run again with SG_NO_INSTALL=1:"
    sed 's/#.*//' packages.txt | grep . >&2
    exit 2
  fi
  local missing
  missing=$(missing_packages)
  if [ -n "$missing" ]; then
    local sudo=""
    if [ "$(id -u)" != 0 ]; then
      if ! command -v sudo >/dev/null; then
        say "These packages are missing and neither root nor sudo is at hand; have them installed:"
        say "$missing"
        exit 2
      fi
      sudo=sudo
    fi
    say "Installing: $(printf '%s' "$missing" | tr '\n' ' ')"
    # shellcheck disable=SC2086
    if ! { $sudo apt-get update -q && DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends $missing; } >"$build/install.log" 2>&1; then
      tail -n 20 "$build/install.log" >&2
      say "apt-get failed; the whole log is $build/install.log"
      exit 2
    fi
  fi
  touch "$stamp"
}

# build TARGET...: configures when needed and builds, showing what went wrong and nothing else.
build_targets() {
  mkdir -p "$build"
  install_packages
  if [ ! -f "$build/build.ninja" ]; then
    if ! cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Release >"$build/configure.log" 2>&1; then
      cat "$build/configure.log" >&2
      exit 4
    fi
    say "Building (a first build takes some minutes)..."
  fi
  if ! ninja -C "$build" "$@" >"$build/build.log" 2>&1; then
    grep -E -A 12 'FAILED|error' "$build/build.log" | head -n 80 >&2
    say "The build failed; the whole log is $build/build.log"
    exit 4
  fi
}
