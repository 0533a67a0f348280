/* Public codes of the material point method: what of each of their options is a scheme of this program. */
#pragma once

/*S
   MpmCodeOption - one option of a code

   option - as a user of the code writes it
   here   - the options of this program that do the same; 'none: ' and why, where there are none; or how the code
            chooses its time step
   file   - the file of the code in which that was read
S*/
typedef struct {
  const char *option, *here, *file;
} MpmCodeOption;

/*S
   MpmCode - one code

   repository - owner/name
   version    - the commit that was read, and its date
   scheme     - options of this program: the scheme that the code runs unless it is told otherwise; NULL: it has none, or
                none that is a scheme of this program
   limit      - what 'critical' with these options prints: the largest stable c dt / h in one dimension, two particles a
                cell, at rest; NULL without a scheme
   options    - up to one whose name is NULL; those of one file follow one another
S*/
typedef struct {
  const char          *name, *repository, *version, *scheme, *limit;
  const MpmCodeOption *options;
} MpmCode;

/* Up to one whose name is NULL. */
extern const MpmCode MpmCodes[];
