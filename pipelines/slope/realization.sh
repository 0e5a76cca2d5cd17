#!/bin/sh
# One realization of a scene through the chain.
#
#     realization.sh PROGRAMS SCENE.toml FOLDER NUMBER PARENT
#
# PARENT is the process that it works for. Whoever starts this asks the kernel to kill it when that one dies (setpriv
# --pdeathsig), and that only holds from then on: if it has died before, nothing is done.
#
# It ends with one of two files in FOLDER, each of which appears whole or not at all:
#   NUMBER.h5      the result: every equilibrium was found
#   NUMBER.failed  which program gave up, with what exit code, and its message
# and NUMBER.log has the summaries. With KEEP=1 in the environment NUMBER-network.h5 and NUMBER-joints.h5 stay;
# SOLVE has options of demsolve.
#
# Exit code 0 if it has ended, either way. A program that was stopped from outside, or that could not write (exit
# code 4), is not the end of a realization: its exit code is handed on, and the next time it is tried again.
set -u
programs=$1 scene=$2 folder=$3 number=$4 parent=$5
ended=$folder/$number work=$folder/$number.work
[ "$PPID" = "$parent" ] || exit 143

# The log is also the lock: whoever else still works at this realization has to end first.
exec 9>>"$ended.log" || exit 4
flock 9 || exit 4
: >"$ended.log"
rm -rf "$work" "$ended.new"
mkdir "$work" || exit 4

# end FILE SUFFIX: the last step gives a file its name under which the realization has ended; by then nothing is left.
end() {
    mv "$work/$1" "$ended.new" && rm -rf "$work" && mv "$ended.new" "$ended.$2" || exit 4
}

# run PROGRAM ARGUMENT...: a program of the chain; it dies with this script, and if it gives up that is the end.
run() {
    program=$1
    shift
    # Here too the parent may have died first; $0 is its number then, and PPID another.
    setpriv --pdeathsig KILL sh -c '[ "$PPID" = "$0" ] || exit 143; exec "$@"' $$ "$programs/$program" "$@" \
        >>"$ended.log" 2>"$work/message"
    code=$?
    cat "$work/message" >>"$ended.log"
    case $code in
        0) return ;;
        4 | 129 | 130 | 137 | 143) # could not read or write; or hung up, interrupted, killed, terminated
            echo "realization $number: $program was stopped (exit code $code); it is tried again the next time" >&2
            cat "$work/message" >&2
            rm -rf "$work"
            exit "$code"
            ;;
    esac
    { echo "$program, exit code $code" && cat "$work/message"; } >"$work/failed" || exit 4
    rm -f "$ended.h5"
    end failed failed
    echo "realization $number: failed"
    exit 0
}

{ # in braces it is read at once: this script may be replaced while it runs
    run jointgen "$scene" --realization "$number" -o "$work/network.h5"
    run strength-averaging "$work/network.h5" -o "$work/joints.h5"
    # shellcheck disable=SC2086 # options, one word each
    run demsolve "$work/joints.h5" ${SOLVE:-} -o "$work/result.h5"

    if [ -n "${KEEP:-}" ]; then
        mv "$work/network.h5" "$ended-network.h5" && mv "$work/joints.h5" "$ended-joints.h5" || exit 4
    fi
    rm -f "$ended.failed"
    end result.h5 h5
    echo "realization $number: equilibrium"
    exit 0
}
