# Completion of lorica for bash. Commands and options are those that --help lists, so that this never lags behind.

_lorica() {
  local word=${COMP_WORDS[COMP_CWORD]} command=
  local i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then
      command=${COMP_WORDS[i]}
      break
    fi
  done
  if [[ -z $command && $word != -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(lorica --help 2>/dev/null | sed -n '/^See it move:/,/^Examples:/s/^  \([a-z][a-z]*\) .*/\1/p')" -- "$word")
  elif [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(lorica ${command:+"$command"} --help 2>/dev/null | sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z-]*\).*/\2/p')" -- "$word")
  else
    compopt -o default 2>/dev/null
    COMPREPLY=()
  fi
}
complete -F _lorica lorica
