/*
 * cost TABLE [count]: lookups through the C interface against the same called from Rust, in turn, at random poses of
 * which all records are in the cache. Processor time, so that waiting for other programs does not count, and each first
 * as often as second. Prints the median of the rounds' ratios, which is to be below 1.1; fails for other answers alone, as
 * no test depends on the time something takes. With `count` one round of each, for callgrind.
 */
#define _POSIX_C_SOURCE 199309L
#include <string.h>
#include <time.h>

#include "common.h"
#include "flangeway.h"

#define POSES 2000
#define ROUNDS 401
#define LIMIT 1.1

double cost_rust(const flangeway_table *table, const flangeway_pose *poses, size_t count);
double cost_c_loop(const flangeway_table *table, const flangeway_pose *poses, size_t count) __attribute__((noinline));

static flangeway_pose poses[POSES];

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double cost_c_loop(const flangeway_table *table, const flangeway_pose *all, size_t count)
{
    double sum = 0.0;
    size_t i;
    for (i = 0; i < count; i++) {
        flangeway_wheel_contacts contacts;
        flangeway_contacts(table, FLANGEWAY_SIDE_RIGHT, &all[i], &contacts);
        sum += contacts.count > 0 ? contacts.contact[0].normal_force : 0.0;
    }
    return sum;
}

int main(int argc, char **argv)
{
    static flangeway_table table;
    double ratios[ROUNDS], checks[2], took[2];
    unsigned char *image;
    size_t length;
    int round, turn, i, rounds = argc > 2 && strcmp(argv[2], "count") == 0 ? 1 : ROUNDS;
    if (argc < 2) {
        return 2;
    }
    image = read_file(argv[1], &length);
    if (flangeway_table_load(&table, sizeof table, image, length) != FLANGEWAY_STATUS_OK) {
        return 2;
    }
    srand(1);
    for (i = 0; i < POSES; i++) {
        poses[i].lateral = 0.012 * rand() / RAND_MAX - 0.006;
        poses[i].yaw = 0.02 * rand() / RAND_MAX - 0.01;
        poses[i].vertical = 5e-4 * rand() / RAND_MAX;
        poses[i].roll = 1e-3 * rand() / RAND_MAX;
    }
    for (round = 0; round < rounds; round++) {
        for (turn = 0; turn < 2; turn++) {
            int c = (turn + round) % 2;
            double begin = now();
            checks[c] = c ? cost_c_loop(&table, poses, POSES) : cost_rust(&table, poses, POSES);
            took[c] = now() - begin;
        }
        ratios[round] = took[1] / took[0];
        if (checks[0] != checks[1]) {
            fprintf(stderr, "cost: different answers\n");
            return 1;
        }
    }
    free(image);
    if (rounds == 1) {
        return 0;
    }
    qsort(ratios, ROUNDS, sizeof *ratios, by_size);
    printf("cost: time, C over Rust %.3f (median of %d rounds, quartiles %.3f to %.3f), %s %.2f\n", ratios[ROUNDS / 2], ROUNDS,
           ratios[ROUNDS / 4], ratios[3 * ROUNDS / 4], ratios[ROUNDS / 2] < LIMIT ? "below" : "not below", LIMIT);
    return 0;
}
