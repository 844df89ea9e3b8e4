# SPDX-License-Identifier: Apache-2.0
# Sourced by ./run and ./test: installs missing packages, configures and builds. Quick when there is nothing to do.
# shellcheck shell=bash

say() { printf '%s\n' "$*" >&2; }

# Lists of packages; ./test adds those of the tests.
package_lists=(packages.txt)

wanted_packages() { sed 's/#.*//' "${package_lists[@]}" | tr -s ' \n' '\n' | grep . | sort -u; }

# Packages of the lists that are not installed.
missing_packages() {
  local have
  have=$(dpkg-query -W -f '${Package} ${db:Status-Status}\n' 2>/dev/null | awk '$2 == "installed" {print $1}' | sort -u)
  comm -23 <(wanted_packages) <(printf '%s\n' "$have")
}

install_packages() {
  # A stamp makes the common case (nothing to do) free of the package manager: it holds the lists that were installed.
  local stamp="$build/packages.ok"
  if [ -f "$stamp" ] && [ -z "$(comm -23 <(wanted_packages) "$stamp")" ]; then return; fi
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    if command -v cmake >/dev/null && command -v ninja >/dev/null && [ -n "${SG_NO_INSTALL:-}" ]; then return; fi
    say "This system has no apt-get. Install what corresponds to these Debian packages, then run again with SG_NO_INSTALL=1:"
    wanted_packages >&2
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
    # What is built depends on what is installed.
    if [ -f "$build/build.ninja" ] && ! cmake "$build" >"$build/configure.log" 2>&1; then
      cat "$build/configure.log" >&2
      exit 4
    fi
  fi
  wanted_packages >"$stamp"
}

# Runs ninja TARGET... and tells how far it is: on a terminal each percent of its steps, elsewhere each tenth one.
ninja_with_progress() {
  local terminal=0
  if [ -t 2 ]; then terminal=1; fi
  NINJA_STATUS='[%f/%t] ' ninja -C "$build" "$@" 2>&1 | tee "$build/build.log" | awk -v terminal="$terminal" '
    match($0, /^\[[0-9]+\/[0-9]+\]/) {
      split(substr($0, 2, RLENGTH - 2), n, "/")
      if (n[2] < 20) next  # a few files are quick
      percent = int(100 * n[1] / n[2])
      if (percent == last) next
      if (terminal) printf "\rBuilding: %3d %%", percent
      else if (int(percent / 10) > int(last / 10)) printf "Building: %d %%\n", percent
      last = percent
      said = 1
      fflush()
    }
    END { if (terminal && said) printf "\r\033[K" }' >&2
  return "${PIPESTATUS[0]}"
}

# build_targets TARGET...: configures when needed and builds; tells progress, and what went wrong. SG_CMAKE: further options of a first
# configuration, e.g. SG_CMAKE="-DSG_PCH=OFF -DSG_WERROR=ON".
build_targets() {
  mkdir -p "$build"
  install_packages
  if [ ! -f "$build/build.ninja" ]; then
    # shellcheck disable=SC2086
    if ! cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Release ${SG_CMAKE:-} >"$build/configure.log" 2>&1; then
      cat "$build/configure.log" >&2
      exit 4
    fi
  fi
  if ! ninja_with_progress "$@"; then
    grep -a -E -A 12 'FAILED|error' "$build/build.log" | head -n 80 >&2
    say "The build failed; the whole log is $build/build.log"
    exit 4
  fi
}
