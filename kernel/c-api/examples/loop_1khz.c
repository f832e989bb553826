/*
 * loop_1khz TABLE [seconds]: a 1 kHz loop as a rig runs it. A wheelset wanders over the track; each step looks up both
 * wheels with Polach's creep forces, and asks for the next step's records before it waits. POSIX; on another system
 * replace wait_until.
 *
 *     gcc -std=c99 -O2 -I include examples/loop_1khz.c target/release/libflangeway_c.a -lm -o loop_1khz
 */
#define _POSIX_C_SOURCE 200112L
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "flangeway.h"

#define PERIOD_NS 1000000L

/* A table begins on a cache line if its memory does. */
#define CACHE_LINE 64

static const double SPEED = 20.0; /* m/s */

static void *load_file(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    void *image = NULL;
    long size;
    if (file == NULL) {
        return NULL;
    }
    if (fseek(file, 0, SEEK_END) == 0 && (size = ftell(file)) > 0) {
        rewind(file);
        if (posix_memalign(&image, CACHE_LINE, (size_t)size) == 0 &&
            fread(image, 1, (size_t)size, file) == (size_t)size) {
            *length = (size_t)size;
        } else {
            free(image);
            image = NULL;
        }
    }
    fclose(file);
    return image;
}

static void wait_until(const struct timespec *time)
{
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, time, NULL) == EINTR) {
    }
}

/* Where the wheelset is: a slow hunting motion, the axle pressed 0.1 mm into the rails. */
static flangeway_motion motion_at(double t, double radius)
{
    const double omega = 6.0;
    flangeway_motion motion = {{0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    motion.pose.lateral = 0.003 * sin(omega * t);
    motion.pose.yaw = 0.001 * cos(omega * t);
    motion.pose.vertical = 1e-4;
    motion.rates.lateral = 0.003 * omega * cos(omega * t);
    motion.rates.yaw = -0.001 * omega * sin(omega * t);
    motion.speed = SPEED;
    motion.spin = SPEED / radius;
    return motion;
}

int main(int argc, char **argv)
{
    static flangeway_table table; /* 4 KiB: not on a small stack */
    const flangeway_friction friction = {0.35f, 1.0f, 0.0f};
    flangeway_info info;
    struct timespec release;
    double longest_late = 0.0, largest_quotient = 0.0;
    double seconds = argc > 2 ? atof(argv[2]) : 1.0;
    long step, steps = (long)(seconds * 1000.0);
    size_t length = 0;
    void *image;
    int32_t status;
    if (argc < 2) {
        fprintf(stderr, "loop_1khz TABLE [seconds]\n");
        return 2;
    }
    if (flangeway_interface_version() != FLANGEWAY_INTERFACE_VERSION) {
        fprintf(stderr, "header and library do not belong together\n");
        return 2;
    }
    image = load_file(argv[1], &length);
    if (image == NULL) {
        fprintf(stderr, "%s: cannot be read\n", argv[1]);
        return 2;
    }
    status = flangeway_table_load(&table, sizeof table, image, length);
    if (status != FLANGEWAY_STATUS_OK) {
        char text[200];
        flangeway_table_problem(image, length, text, sizeof text);
        fprintf(stderr, "%s: %s\n", argv[1], text);
        return 2;
    }
    flangeway_table_info(&table, &info);
    clock_gettime(CLOCK_MONOTONIC, &release);
    for (step = 0; step < steps; step++) {
        flangeway_motion motion = motion_at(1e-3 * (double)step, info.nominal_radius[0]);
        flangeway_motion next = motion_at(1e-3 * (double)(step + 1), info.nominal_radius[0]);
        flangeway_wheelset_forces forces;
        struct timespec now;
        double late;
        int wheel;
        status = flangeway_wheelset(&table, &motion, FLANGEWAY_CREEP_LAW_POLACH, &friction, &forces);
        if (status != FLANGEWAY_STATUS_OK) {
            fprintf(stderr, "step %ld: %s\n", step, flangeway_status_text(status));
            return 1;
        }
        for (wheel = 0; wheel < 2; wheel++) {
            double quotient = fabs(forces.wheel[wheel].derailment_quotient);
            largest_quotient = quotient > largest_quotient ? quotient : largest_quotient;
            flangeway_prefetch(&table, wheel, &next.pose);
        }
        /* Here a rig hands the forces to its actuators and reads the next pose. */
        release.tv_nsec += PERIOD_NS;
        if (release.tv_nsec >= 1000000000L) {
            release.tv_nsec -= 1000000000L;
            release.tv_sec++;
        }
        wait_until(&release);
        clock_gettime(CLOCK_MONOTONIC, &now);
        late = (double)(now.tv_sec - release.tv_sec) + 1e-9 * (double)(now.tv_nsec - release.tv_nsec);
        longest_late = late > longest_late ? late : longest_late;
    }
    printf("%ld steps, largest Y/Q %.3f, latest wake-up %.3f ms\n", steps, largest_quotient, 1e3 * longest_late);
    free(image);
    return 0;
}
