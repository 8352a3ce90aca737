/* SPDX-License-Identifier: MIT
 *
 * Layer 8: where the noise of a picture comes from: pixel (edges), lens, each light, lights seen in
 * mirrors and through glass; and what the knobs against it would buy.
 *
 * The error variance V of the mean of n samples, by the snapshot rule (estimate.h), is measured on
 * pixels spread over the picture: as it is, with one sampling set frozen (V_held), and with all
 * others frozen (V_alone). A frozen set gives all samples of a pixel one and the same point. The
 * share of a set is the mean of V_alone and V - V_held, scaled so that the shares sum to 1: where
 * no more than two sets act together that is the set's own variance plus half of each joint one
 * (Shapley effects; Owen 2014). V_alone without the others sums to less than V: the rest is joint.
 *
 * Variances are a function of (scene, parameters, seed, rounds) only; costs are measured. One
 * thread at a time per object; nothing here waits, and any thread may do it beside a render.
 */
#ifndef FL_NOISE_H
#define FL_NOISE_H

#include "core/frame.h"

enum {
    FL_NOISE_SAMPLES = 16,  /**< n, if one has no other wish. */
    FL_NOISE_PIXELS = 1024, /**< A round's, at most. */
    FL_NOISE_ROUNDS = 4,    /**< Enough for shares good to a few per cent. */
    FL_NOISE_SOURCES_MAX = 3 + FL_FREEZE_LIGHTS_MAX,
    FL_NOISE_LIGHT_SAMPLES_MAX = 64 /**< Largest recommendation. */
};

typedef enum fl_noise_kind {
    FL_NOISE_PIXEL,
    FL_NOISE_LENS,
    FL_NOISE_DEEPER, /**< Disk lights, as seen from reflected and refracted rays. */
    FL_NOISE_LIGHT   /**< A disk light, as seen from camera hits. */
} fl_noise_kind;

/** One sampling set in use. Its figures are parts of V. */
typedef struct fl_noise_source {
    fl_noise_kind kind;
    uint32_t light;     /**< FL_NOISE_LIGHT: number in scene order. */
    double share;       /**< 0 to 1; all sources together 1, or 0 when there is no noise at all. */
    double share_error; /**< Standard error of `share`. */
    double alone;       /**< What is left when all others are frozen. */
    double held;        /**< What is left when this one is frozen. */
} fl_noise_source;

typedef struct fl_noise_split {
    uint32_t source_count;
    fl_noise_source
        sources[FL_NOISE_SOURCES_MAX]; /**< Pixel, lens, deeper, lights: those in use. */
    uint32_t samples, rounds;
    uint64_t pixels;
    double variance; /**< V, mean over pixels and channels; linear radiance squared. */
    double joint;    /**< Part of V that needs two sets together: 1 - sum of `alone`, at least 0. */
    /** CPU seconds of one sample of one pixel without its disk lights' shadow rays, and of one such
     * ray with its shading; 0 where there are none. */
    double path_seconds, shadow_seconds;
    double shadows_per_path; /**< Rays to disk lights per sample at one light sample. */
    double light_samples;    /**< Now, the mean over disk lights; 0: there are none. */
    /** m* = sqrt(cost of a path / of its lights x light / other variance), at least 1, and how much
     * smaller the error would be in the same time. */
    double light_samples_best, light_samples_gain;
} fl_noise_split;

typedef struct fl_noise fl_noise;

/** Prepare to measure; retains `scene`, copies `params`. `samples`: n, a power of two from 4 on.
 * NULL after adding an error. About 0.5 MB. */
fl_noise *fl_noise_create(fl_compiled *scene, const fl_params *params, uint32_t samples,
                          fl_diags *diags);
void fl_noise_destroy(fl_noise *noise);

/** Do the next small piece: one sample of at most FL_NOISE_PIXELS pixels, some milliseconds. To
 * cancel, call it no more. False: out of memory. */
bool fl_noise_step(fl_noise *noise);

/** Rounds completed; each sharpens the result. A round is fl_noise_round_steps pieces. */
uint32_t fl_noise_rounds(const fl_noise *noise);
uint32_t fl_noise_round_steps(const fl_noise *noise);
/** Pieces done since the beginning. */
uint64_t fl_noise_steps(const fl_noise *noise);

/** What the completed rounds say. False: none is complete. */
bool fl_noise_read(const fl_noise *noise, fl_noise_split *out_split);

/** The error that `variance` means: the estimate of estimate.h with its prior rate. */
double fl_noise_rmse(const fl_noise_split *split);

/** "edges", "lens", "lights in reflections", "light 2" (from 1): at most 32 bytes with the end. */
enum { FL_NOISE_NAME_BYTES = 32, FL_NOISE_ADVICE_BYTES = 512 };
void fl_noise_source_name(const fl_noise_source *source, char out_name[FL_NOISE_NAME_BYTES]);

/** One line for people: the largest shares, the knob to turn and what it would buy, e.g.
 * "83 % lens, 12 % light 1, 5 % edges: raise samples: twice as many give 0.66 times the error". */
void fl_noise_advice(const fl_noise_split *split, char out_text[FL_NOISE_ADVICE_BYTES]);

#endif
