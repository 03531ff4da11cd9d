#include <petscts.h>
#include <petscdm.h>

/* The line search that makes the residual least: "l2" up to PETSc 3.23, "secant" from 3.24 on. */
#ifdef SNESLINESEARCHSECANT
#define MPJR_SEARCH_LEAST SNESLINESEARCHSECANT
#else
#define MPJR_SEARCH_LEAST SNESLINESEARCHL2
#endif
