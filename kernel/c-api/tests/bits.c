/*
 * bits TABLE MOTIONS: answers motions through the C interface and prints the bits, as tests/golden does in Rust.
 */
#include <inttypes.h>
#include <string.h>

#include "common.h"
#include "flangeway.h"

static const flangeway_friction FRICTION = {0.35f, 0.4f, 0.6f};

static void need(int32_t status, const char *what)
{
    if (status != FLANGEWAY_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", what, flangeway_status_text(status));
        exit(1);
    }
}

static void print_floats(const float *numbers, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        printf(" %08" PRIx32, bits);
    }
}

static void print_doubles(const double *numbers, size_t count)
{
    size_t i;
    for (i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &numbers[i], sizeof bits);
        printf(" %016" PRIx64, bits);
    }
}

static void print_contacts(const flangeway_wheel_contacts *contacts)
{
    int i;
    printf("%" PRIx32 " %" PRIx32, (uint32_t)contacts->count, contacts->flags);
    for (i = 0; i < contacts->count; i++) {
        const flangeway_contact *c = &contacts->contact[i];
        print_floats(&c->normal_force, 1);
        print_floats(&c->indentation, 1);
        print_floats(c->position, 3);
        print_floats(&c->angle, 1);
        print_floats(&c->rolling_radius, 1);
        print_floats(&c->wheel_coordinate, 1);
        print_floats(c->semi_axes, 2);
        print_floats(&c->wheel_curvature, 1);
        print_floats(&c->rail_curvature, 1);
        printf(" %" PRIx32, (uint32_t)c->slot);
    }
    printf("\n");
}

/* The single functions must give what flangeway_wheelset gives. */
static void compare(const flangeway_table *table, const flangeway_motion *motion, int side, int law,
                    const flangeway_elasticity *elastic, const flangeway_wheel_forces *wheel)
{
    int i;
    for (i = 0; i < wheel->contacts.count; i++) {
        const flangeway_contact *contact = &wheel->contacts.contact[i];
        const flangeway_patch patch = {{contact->semi_axes[0], contact->semi_axes[1]}, contact->normal_force};
        flangeway_creepage creepage;
        flangeway_creep_force force;
        need(flangeway_creepages(table, side, motion, contact, &creepage), "creepages");
        /* Constant friction where none falls: kept from zero slip by its own factor in the golden answers. */
        need(flangeway_creep_forces(law, &patch, elastic, &creepage, 0.3f, &force), "creep forces");
        if (memcmp(&creepage, &wheel->creepages[i], sizeof creepage) != 0) {
            fprintf(stderr, "creepages differ\n");
            exit(1);
        }
        if (law == FLANGEWAY_CREEP_LAW_KALKER && memcmp(&force, &wheel->creep_forces[i], sizeof force) != 0) {
            fprintf(stderr, "creep forces differ\n");
            exit(1);
        }
    }
}

int main(int argc, char **argv)
{
    static flangeway_table table;
    flangeway_wheel *wheels;
    flangeway_wheel_contacts *together;
    flangeway_motion *motions;
    flangeway_info info;
    flangeway_elasticity elastic;
    unsigned char *image;
    size_t length, bytes, count, i;
    int side, law;
    if (argc != 3) {
        fprintf(stderr, "bits TABLE MOTIONS\n");
        return 2;
    }
    image = read_file(argv[1], &length);
    motions = (flangeway_motion *)(void *)read_file(argv[2], &bytes);
    count = bytes / sizeof *motions;
    need(flangeway_table_load(&table, sizeof table, image, length), "table");
    need(flangeway_table_info(&table, &info), "info");
    elastic.shear_modulus = (float)(info.young_modulus / (2.0 * (1.0 + info.poisson_ratio)));
    elastic.poisson_ratio = (float)info.poisson_ratio;
    wheels = calloc(2 * count, sizeof *wheels);
    together = calloc(2 * count, sizeof *together);
    if (wheels == NULL || together == NULL) {
        return 2;
    }
    for (i = 0; i < 2 * count; i++) {
        wheels[i].pose = motions[i / 2].pose;
        wheels[i].side = (int32_t)(i % 2);
    }
    need(flangeway_contacts_many(&table, wheels, 2 * count, together, 2 * count), "many");
    for (i = 0; i < count; i++) {
        for (side = 0; side < 2; side++) {
            flangeway_wheel_contacts contacts;
            need(flangeway_prefetch(&table, side, &motions[i].pose), "prefetch");
            need(flangeway_contacts(&table, side, &motions[i].pose, &contacts), "contacts");
            if (memcmp(&contacts, &together[2 * i + (size_t)side], sizeof contacts) != 0) {
                fprintf(stderr, "contacts of one and of many differ\n");
                return 1;
            }
            print_contacts(&contacts);
        }
        for (law = FLANGEWAY_CREEP_LAW_KALKER; law <= FLANGEWAY_CREEP_LAW_FASTSIM20; law++) {
            flangeway_wheelset_forces forces;
            need(flangeway_wheelset(&table, &motions[i], law, &FRICTION, &forces), "wheelset");
            for (side = 0; side < 2; side++) {
                const flangeway_wheel_forces *wheel = &forces.wheel[side];
                int k;
                compare(&table, &motions[i], side, law, &elastic, wheel);
                for (k = 0; k < wheel->contacts.count; k++) {
                    const flangeway_creepage *slip = &wheel->creepages[k];
                    const flangeway_creep_force *force = &wheel->creep_forces[k];
                    print_floats(&slip->longitudinal, 1);
                    print_floats(&slip->lateral, 1);
                    print_floats(&slip->spin, 1);
                    print_floats(&force->longitudinal, 1);
                    print_floats(&force->lateral, 1);
                    print_floats(&force->spin_moment, 1);
                }
                print_doubles(&wheel->guiding_force, 1);
                print_doubles(&wheel->wheel_load, 1);
                print_doubles(&wheel->derailment_quotient, 1);
                print_doubles(&wheel->wear_index, 1);
                printf("\n");
            }
            print_doubles(forces.force, 3);
            print_doubles(forces.moment, 3);
            printf("\n");
        }
    }
    free(together);
    free(wheels);
    free(motions);
    free(image);
    return 0;
}
