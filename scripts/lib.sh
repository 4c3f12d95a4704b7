# Shared by the scripts beside it: headings with the time so far, quiet commands with a log, builds, the mirror, Monado.
# Sourced with the repository's root as the working directory.

started=$SECONDS

heading() {
  local elapsed=$((SECONDS - started))
  printf '\n== %s  [%d:%02d]\n' "$1" $((elapsed / 60)) $((elapsed % 60))
}

# quietly LOG COMMAND...: output to LOG; on failure its last lines are shown.
quietly() {
  local log=$1 status=0
  shift
  mkdir -p "$(dirname "$log")"
  "$@" >"$log" 2>&1 </dev/null || status=$?
  if [ "$status" -ne 0 ]; then
    local free_mb
    free_mb=$(df --output=avail -m . | tail -n 1)
    if [ "$free_mb" -lt 50 ]; then echo "The disk is full: $((free_mb)) MB are free in $PWD. A build with tests takes about 600 MB." >&2; fi
    tail -n 60 "$log" >&2
    printf 'Failed with %d: %s\nThe whole output is in %s\n' "$status" "$*" "$log" >&2
  fi
  return "$status"
}

# configure FOLDER PRESET OPTION...: CMake, which must be new enough to know presets.
configure() {
  local folder=$1 preset=$2 found
  shift 2
  found=$(cmake --version | sed -n '1s/[^0-9]*//p')
  if [ "$(printf '%s\n' 3.25 "$found" | sort -V | head -n 1)" != 3.25 ]; then
    echo "Lorica needs CMake 3.25 or newer, and this is CMake $found ($(command -v cmake))." >&2
    echo "Debian 12 has 3.25; elsewhere take one from https://cmake.org/download and put it first in PATH." >&2
    return 2
  fi
  quietly "$folder/log-configure.txt" cmake --preset "$preset" -B "$folder" "$@"
}

# build FOLDER [TARGET...]: in a terminal ninja shows its status line, elsewhere its output goes to a log.
build() {
  local folder=$1
  shift
  local command=(cmake --build "$folder" --parallel "$(nproc)" ${1+--target "$@"})
  if [ -t 1 ]; then
    "${command[@]}"
  else
    quietly "$folder/log-build.txt" "${command[@]}"
  fi
}

# mirror_of Debian|Debian-Security: the address of this machine's own mirror. apt lists them once it has read its package
# lists.
mirror_of() {
  apt-get indextargets --format '$(REPO_URI) $(LABEL)' 'Created-By: Packages' 2>/dev/null |
    awk -v label="$1" '$2 == label && !found++ { print $1 }'
}

# make_monado_root FOLDER LOG: a root of Debian 13 with Monado, an OpenXR runtime that Debian 12 lacks (1 GB). Its packages
# are unpacked, not configured: nothing of theirs that is used needs more, and it takes a third of the time.
make_monado_root() {
  local root=$1 log=$2 mirror
  mirror=$(mirror_of Debian)
  mkdir -p "$(dirname "$root")"
  rm -rf --one-file-system "$root" "$root.part"
  debootstrap --foreign --variant=minbase \
    --include=monado-service,libopenxr1-monado,libopenxr-loader1,mesa-vulkan-drivers,libgl1-mesa-dri,libegl1,libgl1,libx11-6 \
    trixie "$root.part" "${mirror:?no Debian mirror among the sources of apt}" \
    >"$log" 2>&1 </dev/null || return 1
  find "$root.part/var/cache/apt/archives" -name '*.deb' -print0 |
    xargs -0 -n 1 -P "$(nproc)" sh -c 'dpkg-deb --extract "$1" "$0"' "$root.part" >>"$log" 2>&1 || return 1
  # What their settings would have linked.
  ln -s blas/libblas.so.3 lapack/liblapack.so.3 "$root.part/usr/lib/x86_64-linux-gnu/"
  rm -r "$root.part/var/cache/apt/archives"
  mv "$root.part" "$root"
}
