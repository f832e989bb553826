/*
 * Stand-in for Simulink's simstruc.h, as far as sfun_flangeway.c uses it, so that the S-function can be compiled and run
 * without Simulink. Written from its documentation; not part of any product.
 */
#ifndef SIMSTRUC_H
#define SIMSTRUC_H

#include <stddef.h>

typedef int int_T;

typedef struct {
    const char *text; /* NULL for a number */
    double number;
} mxArray;

typedef struct {
    mxArray parameters[8];
    int parameter_count, expected_parameters;
    int input_width, output_width;
    double input[64], output[64];
    double sample_time;
    void *work[8];
    const char *error;
} SimStruct;

#define SS_OPTION_EXCEPTION_FREE_CODE 1

#define ssSetNumSFcnParams(S, n) ((S)->expected_parameters = (n))
#define ssGetNumSFcnParams(S) ((S)->expected_parameters)
#define ssGetSFcnParamsCount(S) ((S)->parameter_count)
#define ssSetSFcnParamTunable(S, i, t) ((void)(S), (void)(i), (void)(t))
#define ssGetSFcnParam(S, i) (&(S)->parameters[i])
#define ssSetNumInputPorts(S, n) ((void)(S), (n) == 1)
#define ssSetNumOutputPorts(S, n) ((void)(S), (n) == 1)
#define ssSetInputPortWidth(S, p, n) ((void)(p), (S)->input_width = (n))
#define ssSetInputPortRequiredContiguous(S, p, c) ((void)(S), (void)(p), (void)(c))
#define ssSetInputPortDirectFeedThrough(S, p, d) ((void)(S), (void)(p), (void)(d))
#define ssSetOutputPortWidth(S, p, n) ((void)(p), (S)->output_width = (n))
#define ssSetNumSampleTimes(S, n) ((void)(S), (void)(n))
#define ssSetSampleTime(S, i, t) ((void)(i), (S)->sample_time = (t))
#define ssSetOffsetTime(S, i, t) ((void)(S), (void)(i), (void)(t))
#define ssSetNumPWork(S, n) ((void)(S), (void)(n))
#define ssSetPWorkValue(S, i, p) ((S)->work[i] = (p))
#define ssGetPWorkValue(S, i) ((S)->work[i])
#define ssGetInputPortSignal(S, p) ((void)(p), (const double *)(S)->input)
#define ssGetOutputPortSignal(S, p) ((void)(p), (double *)(S)->output)
#define ssSetOptions(S, o) ((void)(S), (void)(o))
#define ssSetErrorStatus(S, text) ((S)->error = (text))

double mxGetScalar(const mxArray *array);
int mxGetString(const mxArray *array, char *text, size_t capacity);

#endif
