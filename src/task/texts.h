/* Texts that are files in the source, and that the build puts into the library. */
#pragma once

/*S
   MpmNamedText - a text with its name. A list of them ends with a name that is NULL.
S*/
typedef struct {
  const char *name, *text;
} MpmNamedText;

extern const char MpmCodesText[]; /* codes.json, the public codes */
extern const MpmNamedText
    MpmAdapterTexts[]; /* examples/your-code/adapters, by language; and a file that one of them calls */
