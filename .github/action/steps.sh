#!/usr/bin/env bash
# The steps of action.yml. They can be run anywhere:
#
#   steps.sh keys     what the caches are named by, as GITHUB_OUTPUT wants it
#   steps.sh build    builds relume from the checkout that this file is in
#   steps.sh check    compares the scenes below PATHS with their goldens
#
# PATHS   scene files and folders, separated by spaces; default: .
# REPORT  folder for the report; default: relume-report
# BAKES   folder for bakes; default: below RUNNER_TEMP
# RELUME  a program to use instead of building one
set -euo pipefail

checkout=$(cd "$(dirname "$0")/../.." && pwd)
work=${RUNNER_TEMP:-${TMPDIR:-/tmp}}/relume
bakes=${BAKES:-$work/bakes}
exe=""
[ "${RUNNER_OS:-}" != Windows ] || exe=.exe
relume=${RELUME:-$work/release/relume$exe}
read -r -a paths <<<"${PATHS:-.}"

# Digest of the names and contents of files, whose list is read with zeros between.
digest_of_files() {
    local sum="sha256sum"
    command -v sha256sum >/dev/null || sum="shasum -a 256"
    LC_ALL=C sort -z -u | xargs -0 $sum | $sum | cut -c -32
}

keys() {
    local program scenes
    program=$(cd "$checkout" && find src Cargo.toml Cargo.lock -type f -print0 | digest_of_files)
    # A scene's mesh lies beside it, so a file stands for its folder.
    scenes=$(for path in "${paths[@]}"; do
        [ -d "$path" ] || path=$(dirname "$path")
        find "$path" \( -name .git -o -name target \) -prune -o -type f \
            \( -name '*.toml' -o -name '*.obj' -o -name '*.mtl' \) -print0
    done | digest_of_files)
    {
        echo "program=$program"
        echo "scenes=$scenes"
        echo "program-folder=$work/release"
        echo "bakes-folder=$bakes"
    } >>"${GITHUB_OUTPUT:-/dev/stdout}"
}

build() {
    [ ! -x "$relume" ] || return 0
    "${CARGO:-cargo}" build --release --locked --bin relume --manifest-path "$checkout/Cargo.toml" \
        --target-dir "$work/build"
    mkdir -p "$(dirname "$relume")"
    cp "$work/build/release/relume$exe" "$relume"
}

check() {
    "$relume" golden check "${paths[@]}" -o "${REPORT:-relume-report}" --cache-dir "$bakes"
}

case ${1:-} in
keys | build | check) "$1" ;;
*)
    sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
