# Completion of jointcreep's programs for bash: options as --help names them, or files.
_jointcreep()
{
    local word=${COMP_WORDS[COMP_CWORD]}
    COMPREPLY=()
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$1" --help 2>/dev/null | grep -oE -- '--?[a-zA-Z][a-z-]*' | sort -u)" -- "$word")
    fi
}
complete -o default -F _jointcreep jointgen strength-averaging demsolve jointexport creepfit jointverify jointcreep
