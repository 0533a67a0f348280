#!/bin/sh
# status.sh EXPECTED COMMAND...: the command must end with this status.
expected=$1
shift
"$@"
status=$?
[ "$status" -eq "$expected" ] || { echo "status $status, expected $expected"; exit 1; }
