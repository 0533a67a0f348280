/* Who sees how far long work has come. */
#pragma once

/* The line of progress goes to a terminal, if the work takes longer than 2 s, or to whoever asks for it, or to nobody. */
typedef enum { MPM_PROGRESS_ON_TERMINAL, MPM_PROGRESS_ALWAYS, MPM_PROGRESS_NEVER } MpmProgressWish;
