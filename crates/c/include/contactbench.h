/* Contacts among discs and spheres, decided exactly: see docs/PYTHON.md of contactbench.

   Calls return CONTACTBENCH_OK or another code; contactbench_last_error then returns the reason.
   Numbers are read in place and never changed; all lengths are in one unit.

   Generated from crates/c/src by HEADER=write cargo test, in the folder c. */

#ifndef CONTACTBENCH_H
#define CONTACTBENCH_H

#include <stddef.h>
#include <stdint.h>

/**
 * The call succeeded.
 */
#define CONTACTBENCH_OK 0

/**
 * An argument is invalid.
 */
#define CONTACTBENCH_INVALID 1

/**
 * The call needs more memory than exists or is allowed.
 */
#define CONTACTBENCH_MEMORY 2

/**
 * A defect of this library.
 */
#define CONTACTBENCH_DEFECT 3

/**
 * A detector that keeps its buffers, and the contacts of its last scene. Two searches at the same
 * time are an error; several threads may read the contacts between searches.
 */
typedef struct contactbench_detector contactbench_detector;

/**
 * A list of near pairs that is kept between frames (a Verlet list), and the contacts of its last
 * frame. Two steps at the same time are an error; several threads may read the contacts between
 * steps.
 */
typedef struct contactbench_tracker contactbench_tracker;

/**
 * A periodic box. Discs use the first two vectors.
 */
typedef struct contactbench_box {
  /**
   * Three vectors of any direction, one after the other.
   */
  double vectors[9];
  /**
   * Nonzero for each periodic vector; 0 for vectors to be ignored.
   */
  int periodic[3];
  /**
   * The corner at which the vectors start. It does not affect exact contacts.
   */
  double origin[3];
} contactbench_box;

/**
 * A scene. Its numbers must not change while a call reads them.
 */
typedef struct contactbench_scene {
  /**
   * Number of particles.
   */
  size_t n;
  /**
   * Dimension: 2 for discs, 3 for spheres.
   */
  int dim;
  /**
   * Coordinates of the first centre, then of the next: n times dim numbers.
   */
  const double *x;
  /**
   * Number of radii: 1 if all particles share a radius, else n.
   */
  size_t radii;
  /**
   * Radii in the unit of the coordinates.
   */
  const double *r;
  /**
   * The periodic box; NULL for open space.
   */
  const struct contactbench_box *bounds;
} contactbench_scene;

/**
 * Errors of a list of pairs, compared with the truth.
 */
typedef struct contactbench_errors {
  /**
   * Number of pairs that touch.
   */
  uint64_t contacts;
  /**
   * Touching pairs that are not listed.
   */
  uint64_t missed;
  /**
   * Listed pairs that do not touch.
   */
  uint64_t spurious;
  /**
   * Repeated pairs in the list.
   */
  uint64_t duplicate;
  /**
   * Listed pairs of a particle with itself.
   */
  uint64_t self_pairs;
  /**
   * The largest overlap of a missed pair, in mean radii of the two particles.
   */
  double deepest_miss;
  /**
   * The largest gap of a spurious pair, in mean radii of the two particles.
   */
  double widest_false;
} contactbench_errors;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the reason for the last failure in this thread, in one sentence. The text is valid until
 * the next failure.
 */
const char *contactbench_last_error(void);

/**
 * Creates a detector, to be freed by contactbench_free, and stores it in `made`; stores NULL on
 * failure.
 *
 * `detector` is a name with parameters, as in "streamed-nbs:level=avx2"; NULL or an empty text
 * selects the recommended detector. `arithmetic` is "exact", "exact-open" (pairs touch at a
 * distance below ri + rj, not at it), "f64", "f32" or "textbook"; NULL or an empty
 * text selects "exact". `memory_limit` in bytes applies to the arrays and, separately, to the
 * pairs; 0 selects 4 GiB, or a quarter of the machine's memory if that is less.
 */
int contactbench_new(const char *detector,
                     const char *arithmetic,
                     size_t threads,
                     uint64_t memory_limit,
                     struct contactbench_detector **made);

/**
 * Frees a detector with its buffers and contacts; does nothing if it is NULL.
 */
void contactbench_free(struct contactbench_detector *detector);

/**
 * Finds the contacts of a scene: the pairs with |xi - xj| <= ri + rj, and in a box also pairs of a
 * particle and an image. The numbers are read in place. Buffers are reused, so a further call for
 * a similar scene allocates next to nothing.
 */
int contactbench_contacts(struct contactbench_detector *detector,
                          const struct contactbench_scene *scene);

/**
 * Returns the number of contacts of the last scene; 0 if the search for them failed.
 */
size_t contactbench_count(const struct contactbench_detector *detector);

/**
 * Returns the pairs of the last scene: two particle numbers each, from 0, the smaller first. Each
 * pair occurs once (in a box once per image), in no particular order. The pointer is valid until
 * the next search with this detector.
 */
const uint32_t *contactbench_pairs(const struct contactbench_detector *detector);

/**
 * Returns the images of the pairs in a box: dim integers each. The first particle touches the
 * second one shifted by this many vectors of the box. NULL in open space. The pointer is valid
 * until the next search with this detector.
 */
const int32_t *contactbench_images(const struct contactbench_detector *detector);

/**
 * Compares a list of `count` pairs, of particles numbered from 0, with the exact truth. The truth
 * comes from testing all pairs or, for many particles, from detectors that agree. In a box
 * `images` has dim numbers per pair, like contactbench_images; in open space it is NULL.
 * `arithmetic` is as for contactbench_new: a neighbour list is right in "exact-open".
 */
int contactbench_verify(const struct contactbench_scene *scene,
                        const char *arithmetic,
                        size_t count,
                        const uint32_t *pairs,
                        const int32_t *images,
                        struct contactbench_errors *errors);

/**
 * Creates a tracker, to be freed by contactbench_tracker_free, and stores it in `made`; stores
 * NULL on failure.
 *
 * `tracker` is a text such as "verlet(streamed-nbs,rule=top-two,skin=0.3)", with the skin in
 * diameters of the largest particle; NULL or an empty text selects
 * "verlet(streamed-nbs,skin=auto)". The other arguments are those of contactbench_new; a list in a
 * box requires "exact" or "exact-open" arithmetic.
 */
int contactbench_tracker_new(const char *tracker,
                             const char *arithmetic,
                             size_t threads,
                             uint64_t memory_limit,
                             struct contactbench_tracker **made);

/**
 * Frees a tracker with its list and contacts; does nothing if it is NULL.
 */
void contactbench_tracker_free(struct contactbench_tracker *tracker);

/**
 * Finds the contacts of the next frame, as contactbench_contacts does. Radii, box and number of
 * particles may change between frames; the list is then rebuilt if necessary. After an error the
 * next frame counts as the first.
 */
int contactbench_tracker_step(struct contactbench_tracker *tracker,
                              const struct contactbench_scene *scene);

/**
 * Makes the next frame count as the first. Useful before a frame of other particles or a large
 * jump.
 */
int contactbench_tracker_forget(struct contactbench_tracker *tracker);

/**
 * Returns 1 if the last step built the list, else 0.
 */
int contactbench_tracker_built(const struct contactbench_tracker *tracker);

/**
 * Does what contactbench_count does, for the last frame of this tracker.
 */
size_t contactbench_tracker_count(const struct contactbench_tracker *tracker);

/**
 * Does what contactbench_pairs does, for the last frame of this tracker.
 */
const uint32_t *contactbench_tracker_pairs(const struct contactbench_tracker *tracker);

/**
 * Does what contactbench_images does, for the last frame of this tracker.
 */
const int32_t *contactbench_tracker_images(const struct contactbench_tracker *tracker);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CONTACTBENCH_H */
