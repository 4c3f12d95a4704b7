# Shared by the scripts beside it: headings with the time so far, quiet commands with a log, the release build.
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
    tail -n 60 "$log" >&2
    printf 'Failed with %d: %s\nThe whole output is in %s\n' "$status" "$*" "$log" >&2
  fi
  return "$status"
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
