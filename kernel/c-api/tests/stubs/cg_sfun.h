/*
 * Stand-in for the file that binds an S-function's callbacks to its simulator: a program that runs the callbacks in
 * Simulink's order. sfun TABLE prints "sfun: ..." and checks what the S-function answers.
 */
#include <math.h>

double mxGetScalar(const mxArray *array)
{
    return array->number;
}

int mxGetString(const mxArray *array, char *text, size_t capacity)
{
    if (array->text == NULL || strlen(array->text) >= capacity) {
        return 1;
    }
    strcpy(text, array->text);
    return 0;
}

static void set(mxArray *array, const char *text, double number)
{
    array->text = text;
    array->number = number;
}

/* Runs one step with the wheelset at these inputs; NULL or the error. */
static const char *run(SimStruct *S, const char *table, const double *inputs)
{
    static const SimStruct EMPTY;
    *S = EMPTY;
    S->parameter_count = PARAMETERS;
    set(&S->parameters[PARAMETER_TABLE], table, 0.0);
    set(&S->parameters[PARAMETER_LAW], NULL, FLANGEWAY_CREEP_LAW_POLACH);
    set(&S->parameters[PARAMETER_FRICTION], NULL, 0.3);
    set(&S->parameters[PARAMETER_SAMPLE_TIME], NULL, 1e-4);
    mdlInitializeSizes(S);
    mdlInitializeSampleTimes(S);
    mdlStart(S);
    if (S->error == NULL) {
        memcpy(S->input, inputs, INPUTS * sizeof *inputs);
        mdlOutputs(S, 0);
    }
    mdlTerminate(S);
    return S->error;
}

int main(int argc, char **argv)
{
    double inputs[INPUTS] = {0.0002, 0.0, 2e-4, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 20.0 / 0.46, 0.0};
    static SimStruct S;
    const double *y = S.output;
    const char *error;
    if (argc != 2) {
        return 2;
    }
    error = run(&S, argv[1], inputs);
    if (error != NULL || S.input_width != 11 || S.output_width != 20 || S.sample_time != 1e-4) {
        fprintf(stderr, "sfun: %s\n", error == NULL ? "wrong sizes" : error);
        return 1;
    }
    /* The wheels' loads are the vertical force, their guiding forces (outwards) the lateral one. */
    if (!(y[2] < -1e3) || fabs(y[2] + y[7] + y[14]) > 1e-6 || fabs(y[1] + y[6] - y[13]) > 1e-6) {
        fprintf(stderr, "sfun: forces do not add up\n");
        return 1;
    }
    printf("sfun: Q %.1f and %.1f kN\n", 1e-3 * y[7], 1e-3 * y[14]);
    if (run(&S, NULL, inputs) == NULL || run(&S, "missing.fwt", inputs) == NULL || run(&S, argv[0], inputs) == NULL) {
        fprintf(stderr, "sfun: a bad table is not noticed\n");
        return 1;
    }
    inputs[3] = NAN;
    if (run(&S, argv[1], inputs) == NULL) {
        fprintf(stderr, "sfun: NaN is not noticed\n");
        return 1;
    }
    return 0;
}
