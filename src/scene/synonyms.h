/* What others call options and words of this program, so that a refusal can answer with the name here. */
#pragma once

/* Not collective. The option that a name of the field's stands for, or NULL. Case does not matter but for E, K and G. */
const char *MpmOptionCalledHere(const char name[]);

/* Not collective. What a word of the field's is here, as a value of an option, with other options where it needs them; or NULL. */
const char *MpmWordCalledHere(const char option[], const char word[]);
