# shellcheck shell=bash
# Stages with a time stamp and a duration each, for scripts/test and scripts/demo. Source it; it needs bash 4.

stage_names=()
stage_seconds=()
stage_current=""
stage_started=0
script_started=$SECONDS

say() {
    printf '[%s] %s\n' "$(date +%H:%M:%S)" "$*"
}

die() {
    say "$*" >&2
    exit 1
}

# Ends the stage that runs, if one does, and begins the one named.
stage() {
    stage_end
    stage_current=$1
    stage_started=$SECONDS
    say "== $1"
}

stage_end() {
    [ -n "$stage_current" ] || return 0
    stage_names+=("$stage_current")
    stage_seconds+=("$((SECONDS - stage_started))")
    stage_current=""
}

# A line for each ended stage, and the sum.
stage_summary() {
    stage_end
    local i
    for i in "${!stage_names[@]}"; do
        printf '  %-32s %5d s\n' "${stage_names[$i]}" "${stage_seconds[$i]}"
    done
    printf '  %-32s %5d s\n' "so far" "$((SECONDS - script_started))"
}

# For `trap stage_failed EXIT`: says where a script stopped. Silent if it ended well.
stage_failed() {
    local status=$?
    [ "$status" -eq 0 ] || [ -z "$stage_current" ] ||
        say "failed in stage '$stage_current' after $((SECONDS - stage_started)) s (exit status $status)" >&2
    return "$status"
}
