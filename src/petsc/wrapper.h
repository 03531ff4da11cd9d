#include <petscts.h>
#include <petscdm.h>
