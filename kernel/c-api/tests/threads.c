/*
 * threads TABLE: four threads look up the same table at once, and each gets what one alone gets.
 */
#include <pthread.h>
#include <string.h>

#include "common.h"
#include "flangeway.h"

#define POSES 5000

static flangeway_table table;
static flangeway_wheel_contacts alone[POSES];

static flangeway_pose pose_of(int i)
{
    flangeway_pose pose = {0.0, 0.0, 3e-4, 0.0};
    pose.lateral = -0.008 + 0.016 * i / POSES;
    pose.yaw = 0.01 - 0.02 * ((i * 7) % POSES) / POSES;
    return pose;
}

static void *look_up(void *unused)
{
    int i;
    (void)unused;
    for (i = 0; i < POSES; i++) {
        flangeway_pose pose = pose_of(i);
        flangeway_wheel_contacts contacts;
        if (flangeway_contacts(&table, i % 2, &pose, &contacts) != FLANGEWAY_STATUS_OK ||
            memcmp(&contacts, &alone[i], sizeof contacts) != 0) {
            return &table;
        }
    }
    return NULL;
}

int main(int argc, char **argv)
{
    pthread_t threads[4];
    unsigned char *image;
    size_t length;
    int i, failures = 0;
    if (argc != 2) {
        return 2;
    }
    image = read_file(argv[1], &length);
    failures += flangeway_table_load(&table, sizeof table, image, length) != FLANGEWAY_STATUS_OK;
    for (i = 0; i < POSES; i++) {
        flangeway_pose pose = pose_of(i);
        failures += flangeway_contacts(&table, i % 2, &pose, &alone[i]) != FLANGEWAY_STATUS_OK;
    }
    for (i = 0; i < 4; i++) {
        failures += pthread_create(&threads[i], NULL, look_up, NULL) != 0;
    }
    for (i = 0; i < 4; i++) {
        void *result = NULL;
        pthread_join(threads[i], &result);
        failures += result != NULL;
    }
    free(image);
    printf("threads: %s\n", failures == 0 ? "four at once, the same answers" : "different answers");
    return failures != 0;
}
