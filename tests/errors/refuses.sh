#!/bin/sh
# refuses.sh MESSAGE COMMAND...: the command must say MESSAGE once, on standard error, end with status 2, without a
# stack trace, and leave nothing in its folder.
message=$1
shift
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
"$@" >out.log 2>err.log
status=$?
times=$(grep -cF -- "mpmstab: $message" err.log)
said=$(grep -c . err.log)
if [ "$status" -ne 2 ] || [ "$times" -ne 1 ] || grep -q 'PETSC ERROR' err.log out.log; then
  echo "status $status (2 expected), message $times times (1 expected) in $said lines:"
  echo "expected: mpmstab: $message"
  cat err.log out.log
  exit 1
fi
left=$(ls | grep -v -e '^out.log$' -e '^err.log$')
[ -z "$left" ] || { echo "left behind: $left"; exit 1; }
