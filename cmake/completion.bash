# Completion of the perception programs: options and subcommands as --help lists them, else files.
_perception()
{
  local word=${COMP_WORDS[COMP_CWORD]} before=("${COMP_WORDS[@]:0:COMP_CWORD}") i sub=()
  for (( i = 1; i < COMP_CWORD; ++i )); do
    [[ ${before[i]} == [a-z]* ]] && { sub=("${before[i]}"); break; }
  done
  local help words
  help=$("${before[0]}" "${sub[@]}" --help 2>/dev/null || "${before[0]}" --help 2>/dev/null)
  case $word in
    -*) words=$(grep -oE -- '(^|[ ,])--?[a-zA-Z][a-zA-Z-]*' <<<"$help" | tr -d ' ,') ;;
    *) words=$(sed -n '/^Subcommands:/,$s/^  \([a-z][a-z0-9-]*\) .*/\1/p' <<<"$help") ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
  (( ${#COMPREPLY[@]} )) || mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -o filenames -F _perception "${BASH_SOURCE[0]##*/}"
