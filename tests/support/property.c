/* SPDX-License-Identifier: MIT */
#include "support/property.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/seed.h"

/* Tries at a simpler case before the best so far has to do. */
enum { TRIES_MAX = 20000, CHOICES_MAX = 1 << 16 };

typedef struct choices {
    uint64_t value[CHOICES_MAX];
    uint32_t mark[CHOICES_MAX];
    uint32_t count, mark_count;
} choices;

struct property {
    uint64_t state; /* Of the generator (seed.h). */
    bool is_replay; /* Numbers come from `drawn` while it lasts; then they are 0. */
    uint32_t given; /* How many of `drawn` there were before the replay. */
    choices drawn;
    char message[8192];
};

static uint64_t record(property *p, uint64_t value, uint64_t below)
{
    choices *c = &p->drawn;
    assert_true(c->count < CHOICES_MAX);
    if (p->is_replay)
        value = c->count < p->given ? c->value[c->count] : 0;
    if (below > 0 && value >= below)
        value = below - 1;
    c->value[c->count++] = value;
    return value;
}

uint64_t property_below(property *p, uint64_t below)
{
    uint64_t bits = test_bits(&p->state);
    return record(p, below > 0 ? bits % below : bits, below);
}

uint64_t property_given(property *p, uint64_t value, uint64_t below)
{
    return record(p, value, below);
}

double property_between(property *p, double lo, double hi)
{
    double from = lo, to = hi;
    if (lo < 0.0 && hi > 0.0) {
        double up = hi / (hi - lo) * 0x1p32;
        to = (double)property_below(p, UINT64_C(1) << 32) < up ? hi : lo;
        from = 0.0;
    }
    return from + (to - from) * (double)property_below(p, UINT64_C(1) << 52) * 0x1p-52;
}

void property_mark(property *p)
{
    choices *c = &p->drawn;
    if (c->mark_count < CHOICES_MAX)
        c->mark[c->mark_count++] = c->count;
}

bool property_fail(property *p, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(p->message, sizeof p->message, format, list);
    va_end(list);
    return false;
}

/* --- Shrinking -------------------------------------------------------------------------------- */

typedef struct search {
    property *p;
    property_holds *holds;
    void *data;
    choices best; /* Fails. */
    uint32_t tries;
} search;

static bool replay(property *p, const uint64_t *value, uint32_t count, property_holds *holds,
                   void *data)
{
    memmove(p->drawn.value, value, count * sizeof *value);
    p->is_replay = true;
    p->given = count;
    p->drawn.count = p->drawn.mark_count = 0;
    p->message[0] = '\0';
    return holds(p, data);
}

static bool is_simpler(const choices *a, const choices *b)
{
    if (a->count != b->count)
        return a->count < b->count;
    uint32_t i = 0;
    while (i < a->count && a->value[i] == b->value[i])
        i++;
    return i < a->count && a->value[i] < b->value[i];
}

/* Takes the case of these numbers if it fails and is simpler. */
static bool try(search *s, const uint64_t *value, uint32_t count)
{
    if (s->tries++ >= TRIES_MAX || replay(s->p, value, count, s->holds, s->data))
        return false;
    choices *c = &s->p->drawn;
    c->count = c->count < count ? c->count : count;
    while (c->count > 0 && c->value[c->count - 1] == 0) /* What is missing is 0 anyway. */
        c->count--;
    while (c->mark_count > 0 && c->mark[c->mark_count - 1] >= c->count)
        c->mark_count--;
    if (!is_simpler(c, &s->best))
        return false;
    s->best = *c;
    return true;
}

static bool try_without(search *s, uint32_t from, uint32_t to)
{
    static uint64_t value[CHOICES_MAX];
    uint32_t rest = s->best.count - to;
    memcpy(value, s->best.value, from * sizeof *value);
    memcpy(value + from, s->best.value + to, rest * sizeof *value);
    return try(s, value, from + rest);
}

static bool try_value(search *s, uint32_t at, uint64_t number)
{
    static uint64_t value[CHOICES_MAX];
    memcpy(value, s->best.value, s->best.count * sizeof *value);
    value[at] = number;
    return try(s, value, s->best.count);
}

/* As many neighbouring pieces at once as possible. */
static void drop_pieces(search *s)
{
    for (uint32_t size = s->best.mark_count; size > 0; size /= 2) {
        for (uint32_t i = 0; i + size <= s->best.mark_count;) {
            uint32_t end = i + size,
                     to = end < s->best.mark_count ? s->best.mark[end] : s->best.count;
            if (!try_without(s, s->best.mark[i], to))
                i += size;
        }
    }
}

static void drop_numbers(search *s)
{
    for (uint32_t size = 8; size > 0; size /= 2)
        for (uint32_t i = 0; i + size <= s->best.count;)
            if (!try_without(s, i, i + size))
                i++;
}

/* Fractions lose their low bits; what counts something, or chooses, becomes as small as it can be.
 */
static void lower(search *s, uint32_t at)
{
    const uint64_t is_fraction = UINT64_C(1) << 20;
    if (s->best.value[at] == 0 || try_value(s, at, 0))
        return;
    for (uint32_t bits = 63; bits > 0 && at < s->best.count; bits--) {
        uint64_t v = s->best.value[at], rounded = v >> bits << bits;
        if (v >= is_fraction && rounded > 0 && rounded < v && try_value(s, at, rounded))
            break;
    }
    uint64_t holds_at = 0;
    while (at < s->best.count && s->best.value[at] < is_fraction &&
           s->best.value[at] > holds_at + 1) {
        uint64_t middle = holds_at + (s->best.value[at] - holds_at) / 2;
        if (!try_value(s, at, middle))
            holds_at = middle;
    }
}

static void shrink(search *s)
{
    static choices before;
    do {
        before = s->best;
        drop_pieces(s);
        drop_numbers(s);
        for (uint32_t i = 0; i < s->best.count; i++)
            lower(s, i);
    } while (is_simpler(&s->best, &before) && s->tries < TRIES_MAX);
    /* Once more, for what it says. */
    replay(s->p, s->best.value, s->best.count, s->holds, s->data);
}

bool property_check(property_holds *holds, void *data, uint64_t seed, property_case *out,
                    const char **out_message)
{
    static property p;
    static search s;
    p.state = seed;
    p.is_replay = false;
    p.drawn.count = p.drawn.mark_count = 0;
    if (holds(&p, data))
        return true;
    printf("found, of %u numbers: %s\n", p.drawn.count, p.message);
    s = (search){.p = &p, .holds = holds, .data = data, .best = p.drawn};
    shrink(&s);
    *out = (property_case){s.best.value, s.best.count};
    *out_message = p.message;
    return false;
}

void property_run(property_holds *holds, void *data, uint32_t seed, uint32_t count,
                  const property_case *kept, uint32_t kept_count)
{
    static property p;
    for (uint32_t k = 0; k < kept_count; k++)
        if (!replay(&p, kept[k].choices, kept[k].count, holds, data))
            fail_msg("kept case %u: %s", k, p.message);
    seed = test_seed(seed);
    for (uint32_t k = 0; k < count; k++) {
        property_case smallest;
        const char *message;
        if (property_check(holds, data, seed + ((uint64_t)k << 32), &smallest, &message))
            continue;
        printf("case %u fails; the smallest found that does:\n{", k);
        for (uint32_t i = 0; i < smallest.count; i++)
            printf("%s%#llx", i ? ", " : "", (unsigned long long)smallest.choices[i]);
        printf("}\n");
        fail_msg("FL_TEST_SEED=%u, case %u: %s", seed, k, message);
    }
}
