#!/bin/sh
# status.sh EXPECTED MESSAGE COMMAND...: the command must end with this status and say the message once.
expected=$1
message=$2
shift 2
said=$("$@" 2>&1)
status=$?
times=$(printf '%s\n' "$said" | grep -cF -- "$message")
[ "$status" -eq "$expected" ] && [ "$times" -eq 1 ] && exit 0
printf '%s\n' "$said"
echo "status $status (expected $expected), message $times times (expected once): $message"
exit 1
