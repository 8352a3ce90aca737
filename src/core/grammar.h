/* SPDX-License-Identifier: MIT
 *
 * Layer 2: the grammar of scene texts, as one table: which blocks there are, where they may stand,
 * which keys they hold, with value type, range, unit, default and help, in which dialects. The
 * parser, `help scene` and docs/scene-format.md all come from this table; what is not in it does
 * not exist.
 */
#ifndef FL_GRAMMAR_H
#define FL_GRAMMAR_H

#include "core/grammar_ids.h"
#include "core/lex.h"
#include "core/scene.h"

enum {
    FL_OBJECTS_MAX = 1 << 18, /**< Object blocks in a text (meshes come from files). */
    FL_MATERIALS_MAX = 1 << 14,
    FL_LIGHTS_MAX = 1 << 12,
    FL_VIEWS_MAX = 256,
    FL_FILES_MAX = 4096,    /**< Different meshes, and different pictures. */
    FL_CONTROLS_MAX = 4096, /**< Control points of one curve. */
    FL_DEGREE_MAX = 15      /**< Of one Bezier curve. */
};

/** Memory that the meshes and pictures of a scene may take together, those of meshes with what is
 * built over them: generous, so that every file that may be read alone can be. Bytes. */
#define FL_SCENE_MEMORY_LIMIT ((uint64_t)32 << 30)
/** Compiled form and hierarchy of a face, as measured (docs/performance.md). Bytes. */
enum { FL_FACE_MEMORY_ESTIMATE = 86 };

/** Sets of dialects are masks of 1 << fl_dialect. */
enum {
    FL_IN_FIRSTLIGHT = 1 << FL_DIALECT_FIRSTLIGHT,
    FL_IN_PA1 = 1 << FL_DIALECT_PA1,
    FL_IN_M04 = 1 << FL_DIALECT_M04,
    FL_IN_M12 = 1 << FL_DIALECT_M12,
    FL_IN_OURS = FL_IN_FIRSTLIGHT | FL_IN_PA1, /**< Our additions: a PA1 text may use them too. */
    FL_IN_MIT = FL_IN_M04 | FL_IN_M12,
    FL_IN_ALL = FL_IN_OURS | FL_IN_MIT
};

typedef enum fl_value_kind {
    FL_VALUE_NUMBERS, /**< `count` real numbers. */
    FL_VALUE_BRACED,  /**< The same, in braces. */
    FL_VALUE_COLOR,   /**< Three numbers or one grey. */
    FL_VALUE_INTEGER, /**< One whole number. */
    FL_VALUE_PATH,    /**< A word that names a file or folder. */
    FL_VALUE_CHOICE,  /**< One word of `choices`. */
    FL_VALUE_POINTS,  /**< Any number of `[ x y z ]`. */
    FL_VALUE_NOTHING  /**< The key is its own meaning (profile). */
} fl_value_kind;

enum {
    FL_KEY_REQUIRED = 1,
    FL_KEY_REPEATS = 2,   /**< May stand several times; order matters. */
    FL_KEY_ABOVE_LO = 4,  /**< The range excludes its lower end. */
    FL_KEY_TAKES_INF = 8, /**< `inf` is a value. */
    FL_KEY_FLOAT = 32,    /**< Finite also as the float that it becomes. */
    FL_KEY_IGNORED = 16   /**< Read and checked, without effect. */
};

typedef struct fl_key {
    const char *name;
    fl_key_id id;
    fl_value_kind kind;
    uint8_t count; /**< Numbers. */
    uint8_t dialects, flags;
    double lo, hi;        /**< Range of every number; -HUGE_VAL, HUGE_VAL: any finite one. */
    const char *unit;     /**< "" where there is none. */
    const char *standard; /**< Default as it would be written; NULL: none. */
    const char *choices;  /**< Space-separated, FL_VALUE_CHOICE. */
    const char *help;     /**< One sentence, without a full stop. */
} fl_key;

typedef struct fl_block {
    const char *name;
    fl_block_id id;
    uint8_t dialects;
    uint8_t once;     /**< Not 0: blocks of the same number exclude each other in their parent. */
    bool is_named;    /**< A word stands between the name and the brace. */
    uint32_t parents; /**< Mask of 1 << fl_block_id. */
    const fl_key *keys;
    uint32_t key_count;
    const char *help;
} fl_block;

/** All blocks in the order of the documentation; element 0 is the text itself. */
extern const fl_block fl_grammar_blocks[];
extern const uint32_t fl_grammar_block_count;

/** "firstlight", "pa1", "m04", "m12"; the same array as in parse.h. */
extern const char *const fl_dialect_names[FL_DIALECT_COUNT];

/** The key or child block of that name which `dialects` (a mask) share with the table, or NULL.
 * O(table). */
const fl_key *fl_grammar_find_key(const fl_block *block, const fl_token *name, uint32_t dialects);
const fl_block *fl_grammar_find_block(const fl_block *parent, const fl_token *name,
                                      uint32_t dialects);

/** The numbers of a key's default; returns how many (0: no default). */
uint32_t fl_key_default(const fl_key *key, double out_numbers[4]);

/** The key with that meaning in a block of that dialect, or NULL. */
const fl_key *fl_grammar_key_by_id(const fl_block *block, fl_key_id id, fl_dialect dialect);

/** Nearest name of a key or child of `parent`, or NULL (see fl_nearest_name). */
const char *fl_grammar_nearest(const fl_block *parent, const fl_token *name, uint32_t dialects);

/** Position of a word among a key's choices; FL_NONE: not one of them. */
uint32_t fl_key_choice(const fl_key *key, const fl_token *word);

/** Receives text piece by piece. */
typedef void fl_write_fn(void *context, const char *text, size_t bytes);

/** The whole table for a terminal (`help scene`), or as the page docs/scene-format.md. */
void fl_grammar_write_help(fl_write_fn *write, void *context);
void fl_grammar_write_markdown(fl_write_fn *write, void *context);

#endif
