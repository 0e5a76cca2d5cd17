#!/bin/sh
# Tells Snakemake how a job of Slurm is: running, success or failed. It needs no accounting database. A job that Slurm has
# forgotten counts as failed: Snakemake then makes it again, and finds what it has done.
answer=$(scontrol -o show job "$1" 2>&1)
case "$answer" in
    *"Invalid job id"*) echo failed; exit ;;
esac
case "$(printf '%s\n' "$answer" | grep -o 'JobState=[A-Z_]*' | cut -d= -f2)" in
    COMPLETED) echo success ;;
    BOOT_FAIL | CANCELLED | DEADLINE | FAILED | NODE_FAIL | OUT_OF_MEMORY | PREEMPTED | TIMEOUT) echo failed ;;
    *) echo running ;;
esac
