/* YAML: files and texts that hold one mapping. */
#pragma once
#include <mpmstab/compat.h>
#include <yaml.h>

/* What is done with a document; root is a mapping. */
typedef PetscErrorCode (*MpmYamlUse)(void *context, yaml_document_t *document, const yaml_node_t *root);

/*
   MpmYamlReadFile - reads a YAML file and calls use with its document. MpmYamlReadText does the same with a text.

   Collective on PETSC_COMM_WORLD. The first rank reads the file. what and name are what messages call it, such as
   'scene' and its path.

   Errors: PETSC_ERR_USER_INPUT for a file that cannot be read, that is too large or that is not YAML, where the message
   has line and column; for another document than one mapping; and what use refuses.
*/
PetscErrorCode MpmYamlReadFile(const char what[], const char path[], MpmYamlUse use, void *context);
PetscErrorCode MpmYamlReadText(const char what[], const char name[], const char yaml[], MpmYamlUse use, void *context);
