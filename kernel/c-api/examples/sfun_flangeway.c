/*
 * Simulink S-function (level 2) around the C interface: contacts, creep forces and wrench of one wheelset.
 *
 *     mex -I<include> sfun_flangeway.c libflangeway_c.a          (host)
 *     Simulink Coder, Speedgoat: add this file and the static library built for the target to the model's custom code.
 *
 * Parameters   1 table file (string)   2 creep law (a flangeway_creep_law)   3 coefficient of friction
 *              4 sample time, s
 * Input  (11)  pose: lateral m, yaw rad, vertical m, roll rad; their rates; speed m/s; spin rad/s; track curvature 1/m
 * Output (20)  force x y z, N; moment x y z, N m; right wheel, then left wheel: Y N, Q N, Y/Q, wear index N,
 *              contacts, flags, normal force N
 *
 * The bare contact is stiff: exchanged once a step with a step's delay it rings (about 1e9 N/m under a wheelset). Put
 * the wheelset's equations of motion into the same task at 0.1 ms, or take the FMU, which holds both.
 */
#define S_FUNCTION_NAME sfun_flangeway
#define S_FUNCTION_LEVEL 2

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "simstruc.h"

#include "flangeway.h"

enum { PARAMETER_TABLE, PARAMETER_LAW, PARAMETER_FRICTION, PARAMETER_SAMPLE_TIME, PARAMETERS };
enum { INPUTS = 11, WHEEL_OUTPUTS = 7, OUTPUTS = 6 + 2 * WHEEL_OUTPUTS };
enum { WORK_TABLE, WORK_IMAGE, WORKS };

static char error_text[512]; /* Simulink keeps the pointer; only errors write it. */

static void mdlInitializeSizes(SimStruct *S)
{
    int i;
    ssSetNumSFcnParams(S, PARAMETERS);
    if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) {
        return; /* Simulink reports the mismatch. */
    }
    for (i = 0; i < PARAMETERS; i++) {
        ssSetSFcnParamTunable(S, i, 0);
    }
    if (!ssSetNumInputPorts(S, 1) || !ssSetNumOutputPorts(S, 1)) {
        return;
    }
    ssSetInputPortWidth(S, 0, INPUTS);
    ssSetInputPortRequiredContiguous(S, 0, 1);
    ssSetInputPortDirectFeedThrough(S, 0, 1);
    ssSetOutputPortWidth(S, 0, OUTPUTS);
    ssSetNumSampleTimes(S, 1);
    ssSetNumPWork(S, WORKS);
    ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);
}

static void mdlInitializeSampleTimes(SimStruct *S)
{
    ssSetSampleTime(S, 0, mxGetScalar(ssGetSFcnParam(S, PARAMETER_SAMPLE_TIME)));
    ssSetOffsetTime(S, 0, 0.0);
}

static void *read_image(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    void *image = NULL;
    long size;
    if (file == NULL) {
        return NULL;
    }
    if (fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) > 0) {
        rewind(file);
        image = malloc((size_t)size);
        if (image != NULL && fread(image, 1, (size_t)size, file) != (size_t)size) {
            free(image);
            image = NULL;
        }
        *length = (size_t)size;
    }
    fclose(file);
    return image;
}

#define MDL_START
static void mdlStart(SimStruct *S)
{
    char path[400];
    size_t length = 0;
    flangeway_table *table = malloc(sizeof *table);
    void *image;
    if (mxGetString(ssGetSFcnParam(S, PARAMETER_TABLE), path, sizeof path) != 0) {
        free(table);
        ssSetErrorStatus(S, "flangeway: parameter 1 is the table's file name");
        return;
    }
    image = read_image(path, &length);
    if (table == NULL || image == NULL) {
        free(table);
        free(image);
        sprintf(error_text, "flangeway: %s: cannot be read", path);
        ssSetErrorStatus(S, error_text);
        return;
    }
    /* Kept first, so that mdlTerminate frees them whatever happens. */
    ssSetPWorkValue(S, WORK_TABLE, table);
    ssSetPWorkValue(S, WORK_IMAGE, image);
    if (flangeway_table_load(table, sizeof *table, image, length) != FLANGEWAY_STATUS_OK) {
        int used = sprintf(error_text, "flangeway: ");
        flangeway_table_problem(image, length, error_text + used, sizeof error_text - (size_t)used);
        ssSetErrorStatus(S, error_text);
    }
}

static flangeway_pose pose_of(const double *numbers)
{
    flangeway_pose pose;
    pose.lateral = numbers[0];
    pose.yaw = numbers[1];
    pose.vertical = numbers[2];
    pose.roll = numbers[3];
    return pose;
}

static void mdlOutputs(SimStruct *S, int_T tid)
{
    const flangeway_table *table = ssGetPWorkValue(S, WORK_TABLE);
    const double *u = ssGetInputPortSignal(S, 0);
    double *y = ssGetOutputPortSignal(S, 0);
    flangeway_friction friction = {0.0f, 1.0f, 0.0f};
    flangeway_wheelset_forces forces;
    flangeway_motion motion;
    int32_t law = (int32_t)mxGetScalar(ssGetSFcnParam(S, PARAMETER_LAW));
    int32_t status;
    int i, wheel;
    (void)tid;
    friction.coefficient = (float)mxGetScalar(ssGetSFcnParam(S, PARAMETER_FRICTION));
    motion.pose = pose_of(u);
    motion.rates = pose_of(u + 4);
    motion.speed = u[8];
    motion.spin = u[9];
    motion.track_curvature = u[10];
    status = flangeway_wheelset(table, &motion, law, &friction, &forces);
    if (status != FLANGEWAY_STATUS_OK) {
        ssSetErrorStatus(S, flangeway_status_text(status));
        return;
    }
    for (i = 0; i < 3; i++) {
        y[i] = forces.force[i];
        y[3 + i] = forces.moment[i];
    }
    for (wheel = 0; wheel < 2; wheel++) {
        const flangeway_wheel_forces *w = &forces.wheel[wheel];
        double *out = y + 6 + wheel * WHEEL_OUTPUTS;
        out[0] = w->guiding_force;
        out[1] = w->wheel_load;
        out[2] = w->derailment_quotient;
        out[3] = w->wear_index;
        out[4] = w->contacts.count;
        out[5] = w->contacts.flags;
        out[6] = 0.0;
        for (i = 0; i < w->contacts.count; i++) {
            out[6] += w->contacts.contact[i].normal_force;
        }
    }
}

static void mdlTerminate(SimStruct *S)
{
    free(ssGetPWorkValue(S, WORK_TABLE));
    free(ssGetPWorkValue(S, WORK_IMAGE));
}

#ifdef MATLAB_MEX_FILE
#include "simulink.c"
#else
#include "cg_sfun.h"
#endif
