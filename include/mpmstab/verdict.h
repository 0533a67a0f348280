/* Words for what was found. */
#pragma once

typedef enum { MPM_STABLE, MPM_UNSTABLE, MPM_UNDECIDED } MpmVerdict;
extern const char *const MpmVerdictNames[];

/* How the norm of the state grew over the late part of a run. */
typedef enum { MPM_BOUNDED, MPM_LINEAR, MPM_EXPONENTIAL } MpmGrowthKind;
extern const char *const MpmGrowthKindNames[];
