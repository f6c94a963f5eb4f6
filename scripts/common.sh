# Shell functions shared by the scripts of this folder; to be sourced.
# shellcheck shell=bash

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

: "${CMAKE_BUILD_PARALLEL_LEVEL:=$(nproc)}" "${CTEST_PARALLEL_LEVEL:=$(nproc)}" "${CMAKE_GENERATOR:=Ninja}"
export CMAKE_BUILD_PARALLEL_LEVEL CTEST_PARALLEL_LEVEL CMAKE_GENERATOR

# A CUDA toolkit in its usual place need not be on the PATH.
if ! command -v nvcc > /dev/null && [[ -x /usr/local/cuda/bin/nvcc ]]; then PATH=$PATH:/usr/local/cuda/bin; fi

say() { printf '\n==> %s\n' "$*"; }

die() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# usage: prints the comment at the head of the script, less its first line.
usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }

# has PROBE: is this there? A probe is the name of a command, or the path of a file (a pattern, maybe) or a header.
has() {
  case $1 in
    /*) compgen -G "$1" > /dev/null ;;
    */* | *.h) [[ -e /usr/include/$1 || -e /usr/local/include/$1 ]] ;;
    *) command -v "$1" > /dev/null ;;
  esac
}

has_gpu() { nvidia-smi -L > /dev/null 2>&1; }

# install_missing PACKAGE PROBE ...: installs each Debian package whose probe is not there, and says so. Where nothing is
# missing it needs neither root nor a network.
install_missing() {
  local missing=() sudo=()
  while (($#)); do
    has "$2" || missing+=("$1")
    shift 2
  done
  ((${#missing[@]})) || return 0

  say "Installing ${missing[*]}"
  local advice="please install these Debian packages: ${missing[*]}"
  has apt-get || die "there is no apt-get here; $advice"
  if ((EUID)); then
    has sudo || die "apt-get needs root, and there is no sudo; $advice"
    sudo=(sudo)
  fi
  if ! { "${sudo[@]}" apt-get update -q &&
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"; }; then
    die "apt-get failed; $advice"
  fi
}

# install_site_tools: what scripts/site needs where PyPI cannot be reached.
install_site_tools() {
  local modules=/usr/lib/python3/dist-packages
  install_missing \
    python3 python3 \
    python3-sphinx sphinx-build \
    python3-myst-parser $modules/myst_parser/__init__.py \
    furo $modules/furo/__init__.py
}

# configure FOLDER OPTION ...: says what is built for.
configure() {
  local folder=$1
  shift
  if ! has nvcc; then
    say "No CUDA compiler (nvcc) here: host only"
  elif ! has_gpu; then
    say "No GPU here: CUDA programs are built but not run"
  fi
  say "Configuring $folder"
  cmake -S . -B "$folder" "$@"
}
