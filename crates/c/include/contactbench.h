/* Contacts among discs and spheres, decided exactly: see docs/PYTHON.md of contactbench.

   Calls give CONTACTBENCH_OK, or another code and a sentence: contactbench_last_error. Numbers are
   read in place and never changed; all lengths are in one unit.

   Made from crates/c/src by HEADER=write cargo test, in the folder c. */

#ifndef CONTACTBENCH_H
#define CONTACTBENCH_H

#include <stddef.h>
#include <stdint.h>

/**
 * All is well.
 */
#define CONTACTBENCH_OK 0

/**
 * Something is wrong with what was given.
 */
#define CONTACTBENCH_INVALID 1

/**
 * It would take more memory than there is, or than may be used.
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
 * A list of near pairs that is kept from frame to frame (a Verlet list), and the contacts of its
 * last frame. Two steps at the same time are an error; several threads may read the contacts
 * between steps.
 */
typedef struct contactbench_tracker contactbench_tracker;

/**
 * A box in which a scene repeats. Discs use the first two vectors.
 */
typedef struct contactbench_box {
  /**
   * Three vectors, one after the other, of any direction.
   */
  double vectors[9];
  /**
   * Along which of them the scene repeats, if not 0. The others decide nothing.
   */
  int periodic[3];
  /**
   * The corner from which they start. It decides no exact contact.
   */
  double origin[3];
} contactbench_box;

/**
 * A scene. Nobody may write to its numbers while a call reads them.
 */
typedef struct contactbench_scene {
  /**
   * How many particles there are.
   */
  size_t n;
  /**
   * 2 for discs, 3 for spheres.
   */
  int dim;
  /**
   * Coordinates of the first centre, then of the next: n times dim numbers.
   */
  const double *x;
  /**
   * How many radii there are: 1 for all particles, or n.
   */
  size_t radii;
  /**
   * The radii, in the unit of the coordinates.
   */
  const double *r;
  /**
   * The box; NULL for open space.
   */
  const struct contactbench_box *bounds;
} contactbench_scene;

/**
 * What a list of pairs misses and adds, against the truth.
 */
typedef struct contactbench_errors {
  /**
   * Pairs that touch.
   */
  uint64_t contacts;
  /**
   * Of them, those that are not listed.
   */
  uint64_t missed;
  /**
   * Listed pairs that do not touch.
   */
  uint64_t spurious;
  /**
   * Pairs that are listed again.
   */
  uint64_t duplicate;
  /**
   * Particles that are listed with themselves.
   */
  uint64_t self_pairs;
  /**
   * The largest overlap among those missed, in mean radii of the two.
   */
  double deepest_miss;
  /**
   * The widest gap among the spurious ones, in mean radii of the two.
   */
  double widest_false;
} contactbench_errors;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Why the last call of this thread that failed did so, in one sentence; until the next that
 * fails.
 */
const char *contactbench_last_error(void);

/**
 * Makes a detector, to be freed by contactbench_free, and puts it into `made`; NULL where it
 * fails.
 *
 * `detector` is a name with parameters, as in "streamed-nbs:level=avx2", and NULL or an empty text
 * for the one to take without a reason for another. `arithmetic` is "exact", "f64", "f32",
 * "f32-cell" or "textbook", and NULL or an empty text for "exact". `memory_limit` is in bytes, for
 * its arrays and as many for pairs; 0 for 4 GiB, or a quarter of the machine's memory if that is
 * less.
 */
int contactbench_new(const char *detector,
                     const char *arithmetic,
                     size_t threads,
                     uint64_t memory_limit,
                     struct contactbench_detector **made);

/**
 * Frees a detector with its buffers and contacts; nothing if it is NULL.
 */
void contactbench_free(struct contactbench_detector *detector);

/**
 * Finds the contacts of a scene: the pairs with |xi - xj| <= ri + rj, and in a box those of
 * particles with images. The numbers are read in place. A call for a scene like the one before
 * allocates next to nothing.
 */
int contactbench_contacts(struct contactbench_detector *detector,
                          const struct contactbench_scene *scene);

/**
 * How many contacts the last scene has; 0 if the call failed.
 */
size_t contactbench_count(const struct contactbench_detector *detector);

/**
 * The pairs of the last scene: two numbers of particles for each, from 0, the smaller first; each
 * pair once (in a box once for each image), in no particular order. The pointer is valid until the
 * next search with this detector.
 */
const uint32_t *contactbench_pairs(const struct contactbench_detector *detector);

/**
 * In a box the images of the pairs: dim whole numbers for each, so that the first particle touches
 * the second one moved by this many vectors of the box. NULL in open space. The pointer is valid
 * until the next search with this detector.
 */
const int32_t *contactbench_images(const struct contactbench_detector *detector);

/**
 * Holds a list of `count` pairs, of particles numbered from 0, to the exact truth, which is found
 * by testing all pairs, or, of many particles, by detectors that agree. In a box `images` has dim
 * numbers for each pair, as contactbench_images gives them; in open space it is NULL.
 */
int contactbench_verify(const struct contactbench_scene *scene,
                        size_t count,
                        const uint32_t *pairs,
                        const int32_t *images,
                        struct contactbench_errors *errors);

/**
 * Makes a tracker, to be freed by contactbench_tracker_free, and puts it into `made`; NULL where
 * it fails.
 *
 * `tracker` is as in "verlet(streamed-nbs,rule=top-two,skin=0.3)", with the skin in diameters of
 * the largest particle, and NULL or an empty text for "verlet(streamed-nbs,skin=auto)". The other
 * arguments are those of contactbench_new; in a box a list decides in "exact" arithmetic alone.
 */
int contactbench_tracker_new(const char *tracker,
                             const char *arithmetic,
                             size_t threads,
                             uint64_t memory_limit,
                             struct contactbench_tracker **made);

/**
 * Frees a tracker with its list and contacts; nothing if it is NULL.
 */
void contactbench_tracker_free(struct contactbench_tracker *tracker);

/**
 * Finds the contacts of the next frame, as contactbench_contacts does. Radii, box and number of
 * particles may change from frame to frame; the list is then built again where it must be. After
 * an error the next frame is taken as the first.
 */
int contactbench_tracker_step(struct contactbench_tracker *tracker,
                              const struct contactbench_scene *scene);

/**
 * Takes the next frame as the first: it may be of other particles, or far from the last one.
 */
int contactbench_tracker_forget(struct contactbench_tracker *tracker);

/**
 * Whether the list was built in the last step: 1, or 0.
 */
int contactbench_tracker_built(const struct contactbench_tracker *tracker);

/**
 * As contactbench_count, of the last frame.
 */
size_t contactbench_tracker_count(const struct contactbench_tracker *tracker);

/**
 * As contactbench_pairs, of the last frame.
 */
const uint32_t *contactbench_tracker_pairs(const struct contactbench_tracker *tracker);

/**
 * As contactbench_images, of the last frame.
 */
const int32_t *contactbench_tracker_images(const struct contactbench_tracker *tracker);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CONTACTBENCH_H */
