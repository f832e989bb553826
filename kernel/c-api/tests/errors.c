/*
 * errors TABLE: whatever C can check gets its code, and what is said to be written is.
 */
#include <math.h>
#include <string.h>

#include "common.h"
#include "flangeway.h"

static int failures;

static void expect_at(int line, const char *what, int32_t found, int32_t expected)
{
    if (found != expected) {
        fprintf(stderr, "line %d: %s gave %d (%s), not %d (%s)\n", line, what, (int)found, flangeway_status_text(found),
                (int)expected, flangeway_status_text(expected));
        failures++;
    }
}

#define EXPECT(call, name) expect_at(__LINE__, #call, (call), FLANGEWAY_STATUS_##name)
#define CHECK(condition) \
    do { \
        if (!(condition)) { \
            fprintf(stderr, "line %d: %s does not hold\n", __LINE__, #condition); \
            failures++; \
        } \
    } while (0)

/* A pointer one byte off; volatile, so that the compiler and its sanitiser do not know. */
static void *one_off(void *pointer)
{
    char *volatile moved = (char *)pointer + 1;
    return moved;
}

static void tables(const unsigned char *good, size_t length)
{
    static flangeway_table table, copy;
    flangeway_info info;
    flangeway_pose pose = {0.0, 0.0, 0.0, 0.0};
    flangeway_wheel_contacts contacts;
    unsigned char *image = malloc(length + 1);
    char text[256];
    size_t i;
    if (image == NULL) {
        exit(2);
    }
    memcpy(image, good, length);
    EXPECT(flangeway_contacts(&table, 0, &pose, &contacts), NOT_LOADED);
    EXPECT(flangeway_table_load(NULL, sizeof table, image, length), NULL);
    EXPECT(flangeway_table_load(&table, sizeof table, NULL, length), NULL);
    EXPECT(flangeway_table_load(&table, sizeof table - 1, image, length), SHORT_BUFFER);
    EXPECT(flangeway_table_load(one_off(&table), sizeof table, image, length), MISALIGNED);
    EXPECT(flangeway_table_load(&table, sizeof table, image, (size_t)-1), LENGTH);
    EXPECT(flangeway_table_load(&table, sizeof table, image, 0), TABLE_LENGTH);
    EXPECT(flangeway_table_load(&table, sizeof table, image, 7), TABLE_LENGTH);
    EXPECT(flangeway_table_load(&table, sizeof table, image, length - 1), TABLE_LENGTH);
    image[length] = 0;
    EXPECT(flangeway_table_load(&table, sizeof table, image, length + 1), TABLE_LENGTH);
    /* A flipped bit anywhere. */
    for (i = 0; i < length; i += 1 + length / 500) {
        int32_t status;
        image[i] ^= 0x10;
        status = flangeway_table_load(&table, sizeof table, image, length);
        CHECK(status >= FLANGEWAY_STATUS_TABLE_MAGIC && status <= FLANGEWAY_STATUS_TABLE_CONTENT);
        CHECK(flangeway_table_problem(image, length, text, sizeof text) == status && strlen(text) > 10);
        EXPECT(flangeway_table_info(&table, &info), NOT_LOADED);
        image[i] ^= 0x10;
    }
    memcpy(image, "PK\003\004", 4);
    EXPECT(flangeway_table_load(&table, sizeof table, image, length), TABLE_MAGIC);
    memcpy(image, good, length);
    image[4] = 99;
    EXPECT(flangeway_table_load(&table, sizeof table, image, length), TABLE_VERSION);
    image[4] = good[4];
    EXPECT(flangeway_table_problem(image, length, text, sizeof text), OK);
    CHECK(strlen(text) == 0);
    EXPECT(flangeway_table_problem(image, 3, text, 10), SHORT_BUFFER);
    CHECK(strlen(text) == 9);
    EXPECT(flangeway_table_problem(image, length, text, 0), SHORT_BUFFER);
    EXPECT(flangeway_table_problem(image, length, NULL, 10), NULL);
    EXPECT(flangeway_table_load(&table, sizeof table, image, length), OK);
    EXPECT(flangeway_table_info(&table, &info), OK);
    CHECK(info.nominal_radius[0] > 0.1 && info.gauge > 0.5 && info.young_modulus > 1e11);
    EXPECT(flangeway_table_info(&table, NULL), NULL);
    EXPECT(flangeway_table_info(&table, one_off(&info)), MISALIGNED);
    copy = table;
    EXPECT(flangeway_table_info(&copy, &info), NOT_LOADED);
    /* An image at any address. */
    memmove(image + 1, good, length);
    EXPECT(flangeway_table_load(&table, sizeof table, image + 1, length), OK);
    EXPECT(flangeway_contacts(&table, 0, &pose, &contacts), OK);
    free(image);
}

static void lookups(const flangeway_table *table)
{
    flangeway_pose pose = {0.0, 0.0, 2e-4, 0.0};
    flangeway_wheel wheels[20];
    flangeway_wheel_contacts many[20], one;
    double *coordinate;
    int i, k;
    EXPECT(flangeway_contacts(NULL, 0, &pose, &one), NULL);
    EXPECT(flangeway_contacts(table, 0, NULL, &one), NULL);
    EXPECT(flangeway_contacts(table, 0, &pose, NULL), NULL);
    EXPECT(flangeway_contacts(one_off((void *)table), 0, &pose, &one), MISALIGNED);
    EXPECT(flangeway_contacts(table, 0, one_off(&pose), &one), MISALIGNED);
    EXPECT(flangeway_contacts(table, 0, &pose, one_off(&one)), MISALIGNED);
    EXPECT(flangeway_contacts(table, 2, &pose, &one), SIDE);
    EXPECT(flangeway_contacts(table, -1, &pose, &one), SIDE);
    EXPECT(flangeway_contacts(table, 0, &pose, &one), OK);
    CHECK(one.count >= 1 && one.contact[0].normal_force > 0.0f && one.flags == 0);
    EXPECT(flangeway_prefetch(table, 7, &pose), SIDE);
    EXPECT(flangeway_prefetch(table, 0, NULL), NULL);
    /* NaN, infinity and 1e4 in each coordinate. */
    for (i = 0; i < 4; i++) {
        const double bad[] = {NAN, INFINITY, -INFINITY, 1e4, -1e300};
        for (k = 0; k < 5; k++) {
            flangeway_pose none = pose;
            coordinate = (double *)&none + i;
            *coordinate = bad[k];
            memset(&one, 0xff, sizeof one);
            EXPECT(flangeway_contacts(table, 0, &none, &one), NOT_A_NUMBER);
            CHECK(one.count == 0 && one.flags & FLANGEWAY_FLAG_INVALID_INPUT);
            EXPECT(flangeway_prefetch(table, 1, &none), OK);
        }
    }
    for (i = 0; i < 20; i++) {
        wheels[i].pose = pose;
        wheels[i].side = i % 2;
    }
    EXPECT(flangeway_contacts_many(table, wheels, 20, many, 20), OK);
    EXPECT(flangeway_contacts_many(table, wheels, 0, many, 0), OK);
    EXPECT(flangeway_contacts_many(table, wheels, 20, many, 19), SHORT_BUFFER);
    EXPECT(flangeway_contacts_many(table, NULL, 20, many, 20), NULL);
    EXPECT(flangeway_contacts_many(table, wheels, 20, NULL, 20), NULL);
    EXPECT(flangeway_contacts_many(table, wheels, (size_t)-1, many, (size_t)-1), LENGTH);
    wheels[11].pose.yaw = NAN;
    memset(many, 0xff, sizeof many);
    EXPECT(flangeway_contacts_many(table, wheels, 20, many, 20), NOT_A_NUMBER);
    CHECK(many[11].count == 0 && many[10].count >= 1 && many[19].count >= 1);
    wheels[19].side = 5;
    memset(many, 0xff, sizeof many);
    EXPECT(flangeway_contacts_many(table, wheels, 20, many, 20), SIDE);
    CHECK(many[0].count == -1);
}

static void creep(const flangeway_table *table)
{
    const flangeway_patch patch = {{6e-3f, 4e-3f}, 60e3f};
    const flangeway_elasticity steel = {82e9f, 0.28f};
    flangeway_creepage creepage = {1e-3f, -1e-3f, 0.1f};
    const flangeway_friction friction = {0.35f, 1.0f, 0.0f};
    flangeway_friction no_friction = {NAN, 1.0f, 0.0f};
    flangeway_motion motion = {{0.0, 0.0, 2e-4, 0.0}, {0.0, 0.0, 0.0, 0.0}, 20.0, 43.5, 0.0};
    flangeway_wheelset_forces forces;
    flangeway_creep_force force;
    flangeway_contact contact;
    double limit;
    int law, i;
    for (law = 0; law < 5; law++) {
        EXPECT(flangeway_creep_forces(law, &patch, &steel, &creepage, 0.3f, &force), OK);
        CHECK(force.longitudinal < 0.0f && force.lateral > 0.0f);
        EXPECT(flangeway_creep_forces(law, &patch, &steel, &creepage, NAN, &force), NOT_A_NUMBER);
        EXPECT(flangeway_wheelset(table, &motion, law, &friction, &forces), OK);
        CHECK(forces.force[2] < 0.0 && forces.wheel[0].wheel_load > 0.0 && forces.wheel[1].wheel_load > 0.0);
        EXPECT(flangeway_wheelset(table, &motion, law, &no_friction, &forces), NOT_A_NUMBER);
        CHECK(forces.force[2] == 0.0 && forces.wheel[0].contacts.flags == FLANGEWAY_FLAG_INVALID_INPUT);
    }
    EXPECT(flangeway_creep_forces(5, &patch, &steel, &creepage, 0.3f, &force), LAW);
    EXPECT(flangeway_creep_forces(-1, &patch, &steel, &creepage, 0.3f, &force), LAW);
    EXPECT(flangeway_creep_forces(2, NULL, &steel, &creepage, 0.3f, &force), NULL);
    EXPECT(flangeway_creep_forces(2, &patch, NULL, &creepage, 0.3f, &force), NULL);
    EXPECT(flangeway_creep_forces(2, &patch, &steel, NULL, 0.3f, &force), NULL);
    EXPECT(flangeway_creep_forces(2, &patch, &steel, &creepage, 0.3f, NULL), NULL);
    creepage.spin = INFINITY;
    EXPECT(flangeway_creep_forces(2, &patch, &steel, &creepage, 0.3f, &force), NOT_A_NUMBER);
    CHECK(force.longitudinal == 0.0f && force.lateral == 0.0f && force.spin_moment == 0.0f);
    EXPECT(flangeway_wheelset(table, &motion, 9, &friction, &forces), LAW);
    EXPECT(flangeway_wheelset(table, NULL, 2, &friction, &forces), NULL);
    EXPECT(flangeway_wheelset(table, &motion, 2, NULL, &forces), NULL);
    EXPECT(flangeway_wheelset(table, &motion, 2, &friction, NULL), NULL);
    EXPECT(flangeway_wheelset(table, &motion, 2, &friction, &forces), OK);
    contact = forces.wheel[0].contacts.contact[0];
    EXPECT(flangeway_creepages(table, 0, &motion, &contact, &creepage), OK);
    contact.slot = 3;
    EXPECT(flangeway_creepages(table, 0, &motion, &contact, &creepage), SLOT);
    contact.slot = 0;
    contact.angle = NAN;
    EXPECT(flangeway_creepages(table, 0, &motion, &contact, &creepage), NOT_A_NUMBER);
    EXPECT(flangeway_creepages(table, 3, &motion, &contact, &creepage), SIDE);
    /* Each of the motion's eleven numbers. */
    for (i = 0; i < 11; i++) {
        flangeway_motion none = motion;
        ((double *)&none)[i] = NAN;
        memset(&forces, 0xff, sizeof forces);
        EXPECT(flangeway_wheelset(table, &none, 2, &friction, &forces), NOT_A_NUMBER);
        CHECK(forces.force[0] == 0.0 && forces.wheel[1].contacts.count == 0);
        EXPECT(flangeway_creepages(table, 0, &none, &forces.wheel[0].contacts.contact[0], &creepage), NOT_A_NUMBER);
        CHECK(creepage.longitudinal == 0.0f && creepage.lateral == 0.0f && creepage.spin == 0.0f);
    }
    EXPECT(flangeway_nadal_limit(1.2, 0.3, &limit), OK);
    CHECK(limit > 1.28 && limit < 1.29);
    EXPECT(flangeway_nadal_limit(NAN, 0.3, &limit), NOT_A_NUMBER);
    EXPECT(flangeway_nadal_limit(1.2, INFINITY, &limit), NOT_A_NUMBER);
    CHECK(limit == 0.0);
    EXPECT(flangeway_nadal_limit(1.2, 0.3, NULL), NULL);
}

int main(int argc, char **argv)
{
    static flangeway_table table;
    unsigned char *image;
    size_t length;
    int i;
    if (argc != 2) {
        fprintf(stderr, "errors TABLE\n");
        return 2;
    }
    CHECK(flangeway_interface_version() == FLANGEWAY_INTERFACE_VERSION && flangeway_format_version() >= 1);
    CHECK(strlen(flangeway_version()) >= 5);
    for (i = -3; i < 40; i++) {
        CHECK(strlen(flangeway_status_text(i)) > 3);
    }
    image = read_file(argv[1], &length);
    tables(image, length);
    EXPECT(flangeway_table_load(&table, sizeof table, image, length), OK);
    lookups(&table);
    creep(&table);
    free(image);
    if (failures == 0) {
        printf("errors: every code as it should be\n");
    }
    return failures != 0;
}
