/* Three discs, a periodic box, and a list that is compared with the truth. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "contactbench.h"

static void check(int code) {
    if (code != CONTACTBENCH_OK) {
        fprintf(stderr, "%s\n", contactbench_last_error());
        exit(1);
    }
}

int main(void) {
    double x[] = {0.25, 0.5, 1.0, 0.5, 3.75, 0.5};
    double r = 0.375;
    contactbench_scene scene = {.n = 3, .dim = 2, .x = x, .radii = 1, .r = &r, .bounds = NULL};

    contactbench_detector *detector;
    check(contactbench_new(NULL, "exact", 1, 0, &detector));

    /* In open space the first two touch. The detector is kept for the next scene. */
    for (int step = 0; step < 2; step++) {
        check(contactbench_contacts(detector, &scene));
        printf("step %d:", step);
        const uint32_t *pairs = contactbench_pairs(detector);
        for (size_t k = 0; k < contactbench_count(detector); k++)
            printf(" (%u,%u)", (unsigned)pairs[2 * k], (unsigned)pairs[2 * k + 1]);
        printf("\n");
        x[2] += 0.25;
    }
    x[2] = 1.0;

    /* In a channel of length 4 the last one also touches the first. */
    contactbench_box channel = {
        .vectors = {4.0, 0.0, 0.0, 0.0, 1.0},
        .periodic = {1, 0, 1}, /* discs ignore the third vector */
    };
    scene.bounds = &channel;
    check(contactbench_contacts(detector, &scene));
    const uint32_t *pairs = contactbench_pairs(detector);
    const int32_t *images = contactbench_images(detector);
    printf("channel:");
    for (size_t k = 0; k < contactbench_count(detector); k++)
        printf(" (%u,%u) image (%d,%d)", (unsigned)pairs[2 * k], (unsigned)pairs[2 * k + 1],
               (int)images[2 * k], (int)images[2 * k + 1]);
    printf("\n");

    /* A tracker keeps a list of near pairs while particles move. */
    contactbench_tracker *tracker;
    check(contactbench_tracker_new("verlet(streamed-nbs,skin=0.5)", NULL, 1, 0, &tracker));
    for (int step = 0; step < 3; step++) {
        check(contactbench_tracker_step(tracker, &scene));
        printf("tracked: %u contacts%s\n", (unsigned)contactbench_tracker_count(tracker),
               contactbench_tracker_built(tracker) ? ", list built" : "");
        x[2] += 0.125;
    }
    x[2] = 1.0;
    contactbench_tracker_free(tracker);

    /* A list that misses a contact. */
    contactbench_errors errors;
    uint32_t listed[] = {1, 0};
    int32_t none[] = {0, 0};
    check(contactbench_verify(&scene, "exact", 1, listed, none, &errors));
    printf("list: %u of %u missed, by %g mean radii\n", (unsigned)errors.missed,
           (unsigned)errors.contacts, errors.deepest_miss);

    /* A failed call leaves its reason. */
    x[1] = NAN;
    if (contactbench_contacts(detector, &scene) != CONTACTBENCH_INVALID) return 1;
    printf("error: %s\n", contactbench_last_error());
    contactbench_free(detector);
    if (contactbench_new("nsb", NULL, 1, 0, &detector) != CONTACTBENCH_INVALID) return 1;
    if (contactbench_new("nothing", NULL, 1, 0, &detector) != CONTACTBENCH_INVALID) return 1;
    contactbench_free(detector);
    return 0;
}
