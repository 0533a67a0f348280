#!/bin/sh
# freed.sh COMMAND...: the command must end well, and PETSc must have nothing to say about what was never freed.
export PETSC_OPTIONS="${PETSC_OPTIONS:-} -malloc_debug -malloc_dump -objects_dump"
said=$("$@" 2>&1)
status=$?
left=$(printf '%s\n' "$said" | grep -E 'never freed|^\[ *[0-9]+\]')
[ "$status" -eq 0 ] && [ -z "$left" ] && exit 0
printf '%s\n' "$said"
echo "status $status (expected 0), not freed: $left"
exit 1
