#!/usr/bin/env bash
# check_generated.sh PYTHON SCRIPT FILE: FILE is, byte for byte, what SCRIPT writes to standard output.
# Exit 77, which ctest shows as skipped, where there is no python3.
set -euo pipefail
python=$1 script=$2 file=$3
if [[ ! -x $python ]]; then
    echo "skipped: no python3"
    exit 77
fi
if ! cmp <("$python" "$script") "$file"; then
    echo "$file is not what $script writes: run $script $file" >&2
    exit 1
fi
